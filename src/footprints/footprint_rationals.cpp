// SPDX-License-Identifier: GPL-3.0-or-later

// Writes the visible pieces of tubes with rational coordinates (docs/footprints.md). A corner is exact: its
// barycentric weights in the facet are quotients of integers. Directions and rays are integer vectors of
// any length.

#include "footprints/footprint_rationals.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "files/input_error.hpp"
#include "files/streamed_file.hpp"
#include "files/usage_error.hpp"
#include "footprints/footprint_table.hpp"
#include "geometry/footprints/exact_parts.hpp"
#include "geometry/steps/steps.hpp"
#include "geometry/visibility/contradictions.hpp"
#include "geometry/visibility/exact_direction.hpp"
#include "run/abilities.hpp"
#include "run/transmission_ends.hpp"
#include "run/transmission_images.hpp"

namespace tubefoot {
namespace {

using Rational = CGAL::Exact_rational;

/// Number of tubes whose lines are held in memory together.
constexpr std::size_t tubes_a_block = 256;

std::string text(const Rational& value) { return value.str(); }

std::string text(const ExactVector& v) {
  return fmt::format(" {} {} {}", text(v[0]), text(v[1]), text(v[2]));
}

/// Converts metres exactly, because every double is a rational number.
ExactVector exact_metres(glm::dvec3 p) { return {Rational(p.x), Rational(p.y), Rational(p.z)}; }

/// Formats one end of a transmission as lines. Corners of facets lie at their true positions, interpolated
/// between the true positions of the vertices.
class EndLines {
 public:
  EndLines(const WorldGrid& grid, const TransmissionEnd& end)
      : end_(end), unit_m_(grid.unit_m()), apex_m_(exact_metres(grid.to_metres(end.tubes.apex))) {}

  std::string apex() const { return text(apex_m_); }
  std::string point(const ExactWeights& weights, const std::array<VertexId, 3>& vertex) const {
    std::array<ExactVector, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = place(vertex[k]);
    return text(between(weights, corners));
  }
  void piece(const TubeVisibility& seen, const NamedPiece& piece, std::string& lines) const {
    lines += fmt::format("piece {} {}", end_.number_of(piece.facet), piece.count);
    for (const ExactWeights& weights : exact_weights(*end_.mesh, end_.tubes.apex, seen, piece))
      lines += point(weights, end_.mesh->facets[piece.facet]);
    lines += '\n';
  }
  /// Writes the directions to the corners of a piece, apparent or in the unobstructed region.
  void cone(const char* what, const TubeVisibility& seen, const NamedPiece& piece, std::string& lines) const {
    lines += fmt::format("{} {}", what, piece.count);
    for (const ExactVector& d :
         exact_directions({*end_.mesh, end_.tubes.apex, seen.rays}, seen.corners, piece))
      lines += text(d);
    lines += '\n';
  }
  bool is_seen_elsewhere() const { return end_.apparent != nullptr; }

 private:
  /// Returns the true position of a vertex. It is a point of the grid, or the doubles that the rays through
  /// stratified water gave.
  ExactVector place(VertexId vertex) const {
    if (end_.apparent != nullptr) return exact_metres(end_.apparent->truth[vertex]);
    const ExactVector way = exact(end_.mesh->vertices[vertex] - end_.tubes.apex);
    ExactVector point;
    for (std::size_t k = 0; k < 3; ++k) point[k] = apex_m_[k] + unit_m_ * way[k];
    return point;
  }

  const TransmissionEnd& end_;
  Rational unit_m_;
  ExactVector apex_m_;
};

}  // namespace

struct RationalsFile::State {
  StreamedFile file;
  std::size_t sensor;
  tbb::enumerable_thread_specific<VisibilityScratch> threads;

  void write(const std::string& lines) { file.append(lines); }
};

RationalsFile::RationalsFile(const std::filesystem::path& file, const Transmissions& transmissions,
                             std::size_t sensor) {
  require_able(transmissions.survey(), transmissions.request(), Feature::exact_corners, sensor);
  if (const Scene& scene = transmissions.survey().scene; !is_order_wanted(scene, 1))
    throw InputError(scene.description.paths.place,
                     "'only_order' excludes paths of order 1, the only paths with exact corners: use another "
                     "format, or leave out 'only_order'");
  state_.reset(new State{StreamedFile(file), sensor, {}});
  state_->write(fmt::format(
      "# tubefoot exact footprints, version 2\n"
      "# transmission PING TRANSMISSION APEX; tube NUMBER BEAM AXIS RAY RAY RAY RAY; piece FACET N POINT...; "
      "open "
      "N DIRECTION...\n"
      "# through refracting water, after each piece: seen N DIRECTION...\n"
      "# with a separate receiver: receiver APEX, its tubes, and shared FACET TUBE RECEIVE_TUBE N POINT...\n"
      "# points: metres east, north and up in the local frame; axes, rays and directions: "
      "integers of any length\nsensor {}\n",
      transmissions.survey().sensors[sensor].sensor->description().name));
}

RationalsFile::~RationalsFile() = default;

std::size_t RationalsFile::add(const Transmission& transmission, std::span<const std::uint32_t> beams) {
  const std::vector<std::uint32_t> chosen = tubes_of_beams(transmission, state_->sensor, beams);
  if (chosen.empty()) return 0;
  const TransmissionEnds ends(transmission, state_->sensor);
  state_->write(fmt::format("transmission {} {}{}\n", transmission.ping(), transmission.number(),
                            EndLines(transmission.scene().grid, ends.tx()).apex()));
  // Beams are those of the receiver, which may record sound from any tube of a separate transmitter.
  TransmissionEnd rx = ends.rx();
  rx.tubes = only_tubes(std::move(rx.tubes), chosen);
  if (!ends.are_two()) return add_end(transmission, rx, chosen, nullptr);
  const TransmissionEnd& tx = ends.tx();
  std::vector<std::uint32_t> all(tx.tubes.tubes.size());
  std::iota(all.begin(), all.end(), 0u);
  std::vector<TubeVisibility> sent, received;
  std::size_t pieces = add_end(transmission, tx, all, &sent);
  state_->write(fmt::format("receiver{}\n", EndLines(transmission.scene().grid, rx).apex()));
  pieces += add_end(transmission, rx, chosen, &received);
  const double unit_m = transmission.scene().grid.unit_m();
  if (ends.apparent_pair() != nullptr)
    add_shared(
        tx, chosen,
        FootprintSharer({tx.tubes, sent, tx.mesh, tx.name}, {rx.tubes, received, rx.mesh, rx.name}, unit_m),
        transmission.scene().grid);
  else
    add_shared(tx, chosen, FootprintSharer(*tx.mesh, {tx.tubes, sent}, {rx.tubes, received}, unit_m),
               transmission.scene().grid);
  return pieces;
}

std::size_t RationalsFile::add_end(const Transmission& transmission, const TransmissionEnd& end,
                                   std::span<const std::uint32_t> numbers,
                                   std::vector<TubeVisibility>* kept) {
  State& s = *state_;
  const std::vector<std::uint32_t>& beam_of_tube =
      transmission.sensor(s.sensor).beam_of_tube(transmission.number());
  const std::vector<std::uint32_t>& beams_of_transmission =
      transmission.sensor(s.sensor).beams_of_transmission(transmission.number());
  VisibilityOptions options = transmission.request().visibility;
  options.open_water = true;
  const EndLines lines(transmission.scene().grid, end);
  if (kept) kept->resize(numbers.size());
  std::size_t pieces = 0;
  Steps steps("tubes", numbers.size());
  for (std::size_t begin = 0; begin < numbers.size(); begin += tubes_a_block) {
    const std::size_t stop = std::min(begin + tubes_a_block, numbers.size());
    std::vector<std::string> of_tube(stop - begin);
    std::vector<std::size_t> count(stop - begin);
    tbb::parallel_for(begin, stop, [&](std::size_t tube) {
      const auto t = static_cast<std::uint32_t>(tube);
      TubeVisibility seen;
      see(*end.mesh, *end.tree, end.tubes, t, options, s.threads.local(), seen);
      if (options.arithmetic == Arithmetic::plain_double)
        leave_out_contradictions(*end.mesh, end.tubes.apex, seen);
      steps.done();
      std::string& out = of_tube[tube - begin];
      out = fmt::format("tube {} {}{}", numbers[tube], beams_of_transmission[beam_of_tube[numbers[tube]]],
                        text(gnomonic_axis(end.tubes, t)));
      for (const std::uint32_t ray : end.tubes.tubes[tube]) out += text(exact(end.tubes.rays[ray]));
      out += '\n';
      for (const NamedPiece& piece : seen.pieces) {
        stop_if_wanted();
        lines.piece(seen, piece, out);
        if (lines.is_seen_elsewhere()) lines.cone("seen", seen, piece, out);
      }
      for (const NamedPiece& piece : seen.open) {
        stop_if_wanted();
        lines.cone("open", seen, piece, out);
      }
      count[tube - begin] = seen.pieces.size();
      if (kept) (*kept)[tube] = std::move(seen);
    });
    for (std::size_t k = 0; k < of_tube.size(); ++k) {
      s.write(of_tube[k]);
      pieces += count[k];
    }
  }
  return pieces;
}

void RationalsFile::add_shared(const TransmissionEnd& tx, std::span<const std::uint32_t> receive_tubes,
                               const FootprintSharer& sharer, const WorldGrid& grid) {
  const EndLines lines(grid, tx);
  for (std::size_t begin = 0; begin < sharer.facets(); begin += tubes_a_block) {
    const std::size_t stop = std::min(begin + tubes_a_block, sharer.facets());
    std::vector<std::string> of_facet(stop - begin);
    tbb::parallel_for(begin, stop, [&](std::size_t number) {
      std::string& to = of_facet[number - begin];
      for (const ExactPart& part : sharer.exact(number)) {
        to += fmt::format("shared {} {} {} {}", tx.number_of_name(part.facet), part.transmit_tube,
                          receive_tubes[part.receive_tube], part.corners.size());
        for (const ExactWeights& weights : part.corners) to += lines.point(weights, part.vertex);
        to += '\n';
      }
    });
    for (const std::string& text : of_facet) state_->write(text);
  }
}

void RationalsFile::close() { state_->file.close(); }

}  // namespace tubefoot
