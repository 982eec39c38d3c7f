// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/bistatic_echo.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "engine/echo/texture_cells.hpp"
#include "engine/law/radial_law.hpp"
#include "geometry/integrals/path_cut.hpp"
#include "geometry/work/steps.hpp"

namespace tubefoot {
namespace {

/// Facets that one task takes: results are gathered by task, so the number is part of the summation's order.
constexpr std::size_t facets_per_task = 32;

std::size_t tasks_for(std::size_t facets) { return (facets + facets_per_task - 1) / facets_per_task; }

std::vector<TubeVisibility> look(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes,
                                 const VisibilityOptions& options) {
  std::vector<TubeVisibility> seen(tubes.tubes.size());
  tbb::enumerable_thread_specific<VisibilityScratch> threads;
  Steps steps("tubes", seen.size());
  tbb::parallel_for(std::uint32_t{0}, std::uint32_t(seen.size()), [&](std::uint32_t tube) {
    see(mesh, tree, tubes, tube, options, threads.local(), seen[tube]);
    steps.done();
  });
  return seen;
}

void check_exact(const VisibilityOptions& options) {
  if (options.arithmetic == Arithmetic::plain_double)
    throw std::invalid_argument(
        "a transmitter and a receiver apart need an exact arithmetic: fixed, filtered or rational");
}

void share(const FootprintSharer& sharer, SharedFootprints& shared) {
  std::vector<SharedFootprints> parts(tasks_for(sharer.facets()));
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t task) {
    const std::size_t end = std::min((task + 1) * facets_per_task, sharer.facets());
    for (std::size_t k = task * facets_per_task; k < end; ++k) sharer.append(k, parts[task]);
  });
  shared.receiver_m = sharer.receiver_m();
  for (const SharedFootprints& part : parts) append(shared, part);
}

void check(const BistaticHistory& history, const BistaticBeams& beams, const EchoLaw& law, double tolerance) {
  const auto refuse = [](std::string_view what) { throw std::invalid_argument(std::string(what)); };
  const std::size_t sent = history.transmit.tubes.size(), heard = history.receive.tubes.size();
  if (beams.count < 0) refuse(fmt::format("a receiver cannot have {} beams", beams.count));
  if (beams.of_receive_tube.size() != heard)
    refuse(fmt::format("the receiver has {} tubes, but {} have a beam", heard, beams.of_receive_tube.size()));
  for (const std::uint32_t beam : beams.of_receive_tube)
    if (beam >= std::uint32_t(beams.count))
      refuse(fmt::format("a tube belongs to beam {} of {}", beam, beams.count));
  const bool fans = !beams.fan_of_transmit_tube.empty() || !beams.fan_of_receive_tube.empty();
  if (fans && (beams.fan_of_transmit_tube.size() != sent || beams.fan_of_receive_tube.size() != heard))
    refuse("fans must be given for all transmit and all receive tubes, or for none");
  if (!law.facet_factor.empty()) refuse("apparent facets belong to one apex, not to two");
  if (!(law.absorption_db_per_m >= 0 && std::isfinite(law.absorption_db_per_m)))
    refuse(fmt::format("absorption must be finite and not negative, not {} dB/m", law.absorption_db_per_m));
  if (!law.reflectivity.empty() && law.reflectivity.size() != law.material_mu.size())
    refuse(fmt::format("{} materials have a Lambert parameter, but {} a texture or none",
                       law.material_mu.size(), law.reflectivity.size()));
  if (!history.paired.empty() && history.paired.size() != history.shared.facets.size())
    refuse("the history's paired facets belong to other facets");
  if (!(tolerance > 0)) refuse(fmt::format("a tolerance must be above 0, not {}", tolerance));
  for (const SharedFacet& facet : history.shared.facets)
    if (facet.facet >= law.material.size() || law.material[facet.facet] >= law.material_mu.size())
      refuse(fmt::format("facet {} has no material with a Lambert parameter", facet.facet));
  if (!law.scattering.empty() && law.scattering.size() != law.material_mu.size())
    refuse(fmt::format("{} scattering laws do not fit {} materials", law.scattering.size(),
                       law.material_mu.size()));
  if (law.patterns == nullptr) return;
  const BeamPatterns& patterns = *law.patterns;
  bool fits = patterns.receive.size() == std::size_t(beams.count) && patterns.fan_of_tube.size() == heard &&
              patterns.beams_of_tube.size() == heard;
  for (const std::uint32_t fan : patterns.fan_of_tube) fits = fits && fan < patterns.transmit.size();
  for (const auto& [first, end] : patterns.beams_of_tube)
    fits = fits && first <= end && end <= std::uint32_t(beams.count);
  if (!fits) refuse("the beam patterns belong to other beams or other tubes");
}

/// Borders of the samples; refuses those that are none, as integrate_echo() does.
std::vector<double> borders_of(const RangeSamples& samples) {
  const std::vector<double> borders = sample_borders_m(samples);
  if (borders.size() < 2 || !(borders.front() >= 0) || !std::isfinite(borders.back()) ||
      !(samples.step_m > 0))
    throw std::invalid_argument(fmt::format(
        "range samples need a first range that is not negative, a step above 0 and a count of one or "
        "more, all finite; not {} m, {} m and {}",
        samples.first_m, samples.step_m, samples.count));
  return borders;
}

/// The largest angle, at most 1, over which two patterns together change little: where their growth in the
/// complex plane is small, rules of few nodes resolve them.
double resolution_of(const Directivity& transmit, const Directivity& receive) {
  double angle = 1;
  while (transmit.growth(angle / 2) + receive.growth(angle / 2) > 3 && angle > 1e-6) angle /= 2;
  return angle;
}

double resolution_of(const ScatteringLaw& law) {
  double angle = 1;
  while (law.growth(angle / 2) > 3 && angle > 1e-6) angle /= 2;
  return angle;
}

bool is_table(const Directivity& pattern) { return pattern.kind == Directivity::Kind::table; }

/// One per thread.
class FacetEcho {
 public:
  FacetEcho(const BistaticHistory& history, const BistaticBeams& beams, std::span<const double> borders,
            const EchoLaw& law, double tolerance, const PathLoss* loss)
      : history_(history),
        beams_(beams),
        law_(law),
        loss_(loss),
        borders_(borders),
        cutter_(borders),
        beta_(two_way_absorption_per_m(law.absorption_db_per_m) / 2),
        tolerance_(tolerance) {
    if (loss == nullptr) return;
    // A rough surface's loss changes by e where the sum of the sines' squares does by 1 / roughness.
    for (const MirrorLoss* l : {&loss->transmit, &loss->receive})
      if (!l->rough_normals.empty())
        smooth_angle_ =
            std::min(smooth_angle_, 1 / std::sqrt(l->roughness * double(l->rough_normals.size())));
    smooth_angle_ = std::max(smooth_angle_, least_smooth_angle);
  }

  using Part = std::pair<std::size_t, double>;  // bin, energy

  /// `number`: the facet's in the history.
  void add(std::size_t number, std::vector<Part>& parts) {
    const SharedFootprints& shared = history_.shared;
    const SharedFacet& facet = shared.facets[number];
    paired_ = history_.paired.empty() ? nullptr : &history_.paired[number];
    scattering_ = law_.law_of(facet.facet);
    texture_ = law_.texture(facet.facet);
    paired_ == nullptr ? place(facet) : place(facet, *paired_);
    smooth_rad_ = scattering_ != nullptr ? resolution_of(*scattering_) : 1;
    cornered_ = scattering_ != nullptr && (scattering_->pieces().size() > 1 || scattering_->is_pointed());
    if (cornered_) smooth_rad_ = std::min(smooth_rad_, 0.1);  // rules of few nodes do not see a corner
    for (std::uint32_t k = 0; k < facet.piece_count; ++k) {
      const SharedPiece& piece = shared.pieces[facet.first_piece + k];
      if (!same_fan(piece)) continue;
      assign(std::span(shared.corners_m).subspan(piece.first, piece.count));
      const auto add_part = [&](const PlanarPolygon& part) {
        law_.patterns == nullptr ? add_plain(part, piece, parts) : add_weighed(part, piece, parts);
      };
      if (texture_ == nullptr)
        add_part(polygon_);
      else
        cells_.cut(polygon_, lies_, texture_->cells(), add_part);
    }
  }

 private:
  /// A facet that lies where it is seen.
  void place(const SharedFacet& facet) {
    plane_ = {facet.plane_normal, facet.transmit_distance_m};
    frame_ = PlaneFrame(plane_);
    receiver_ = {facet.receive_distance_m, frame_.project(history_.shared.receiver_m)};
    transmit_down_ = -plane_.distance_m * plane_.normal;
    receive_down_ = -facet.receive_distance_m * plane_.normal;
    own_ = 1;
    factor_ =
        law_.material_mu[law_.material[facet.facet]] * facet.transmit_distance_m * facet.receive_distance_m;
    if (texture_ != nullptr) lies_ = law_.lying(facet.facet, plane_, frame_);
  }
  /// One that both see elsewhere.
  void place(const SharedFacet& facet, const PairedFacet& paired) {
    plane_ = {facet.plane_normal, paired.transmit_distance_m};
    receiver_ = {paired.receive_distance_m, paired.receive_foot_m};
    own_ = paired_factor(paired, scattering_);
    factor_ = law_.material_mu[law_.material[facet.facet]] * own_ * paired.transmit_distance_m *
              paired.receive_distance_m;
    lies_ = paired.lies;
  }
  void assign(std::span<const glm::dvec3> corners_m) {
    if (paired_ == nullptr) {
      polygon_.assign(corners_m, plane_, frame_);
      return;
    }
    polygon_.distance = plane_.distance_m;
    polygon_.first = glm::dvec2(paired_->to_plane.at(corners_m[0]));
    polygon_.offsets.clear();
    for (const glm::dvec3& corner : corners_m)
      polygon_.offsets.emplace_back(glm::dvec2(paired_->to_plane.linear * (corner - corners_m[0])));
  }

  bool same_fan(const SharedPiece& piece) const {
    return beams_.fan_of_transmit_tube.empty() ||
           beams_.fan_of_transmit_tube[piece.transmit_tube] == beams_.fan_of_receive_tube[piece.receive_tube];
  }

  double density(glm::dvec2 p, double rt, double rr) const {
    const double even = even_density(rt, rr);
    return texture_ == nullptr ? even : even * texture_->factor(lies_.foot_m + p.x * lies_.u + p.y * lies_.v);
  }

  double even_density(double rt, double rr) const {
    if (scattering_ != nullptr) {
      const double loss = own_ * std::exp(-beta_ * (rt + rr)) / (rt * rt * (rr * rr));
      return loss * std::sqrt(cross_section(plane_.distance_m, rt) * cross_section(receiver_.distance, rr));
    }
    return factor_ * std::exp(-beta_ * (rt + rr)) / (rt * rt * rt * (rr * rr * rr));
  }

  /// No rule converges across a corner of a law or a row of a table: there, cells are halved so often and
  /// then taken as they are.
  void refine(bool cornered, bool tables) {
    work_.tolerance = cornered ? std::max(tolerance_, tolerance_with_corners) : tolerance_;
    work_.agreements = cornered ? 2 : 1;
    work_.most_refinements =
        cornered || tables ? most_refinements_with_tables : PathCutter::Work().most_refinements;
  }

  /// On a plane at that distance, at a range.
  double cross_section(double distance, double range) const {
    const double sine = std::min(distance / range, 1.0);
    return scattering_->cross_section(sine,
                                      std::sqrt(std::max(range * range - distance * distance, 0.0)) / range);
  }

  struct Directions {
    glm::dvec3 from_transmitter, from_receiver;
  };
  Directions directions(glm::dvec2 p, double rt, double rr) const {
    if (paired_ != nullptr) return {paired_->transmit_seen.towards(p), paired_->receive_seen.towards(p)};
    const glm::dvec2 q = p - receiver_.foot;
    return {(transmit_down_ + p.x * frame_.u + p.y * frame_.v) / rt,
            (receive_down_ + q.x * frame_.u + q.y * frame_.v) / rr};
  }
  double lost(const Directions& d) const {
    return loss_->transmit.at(d.from_transmitter) * loss_->receive.at(d.from_receiver);
  }

  void integrate(const PlanarPolygon& polygon, const PathCutter::Integrand& integrand,
                 std::uint32_t first_beam, std::vector<Part>& parts) {
    const auto [first, end] = cutter_.samples_of(polygon, receiver_);
    if (first == end) return;
    sum_.resize(work_.values * (borders_.size() - 1), 0);
    cutter_.add(polygon, receiver_, integrand, work_, sum_);
    const std::size_t skipped = work_.values > 1 ? 1 : 0;  // the integral without patterns
    for (std::size_t k = first; k < end; ++k)
      for (std::size_t v = 0; v < work_.values; ++v)
        if (const double energy = std::exchange(sum_[k * work_.values + v], 0); energy != 0 && v >= skipped)
          parts.emplace_back((first_beam + v - skipped) * (borders_.size() - 1) + k, energy);
  }

  void add_plain(const PlanarPolygon& polygon, const SharedPiece& piece, std::vector<Part>& parts) {
    work_.values = 1;
    work_.resolution_rad = std::min(smooth_rad_, smooth_angle_);
    refine(cornered_, false);
    integrate(
        polygon,
        [&](glm::dvec2 p, double rt, double rr, std::span<double> values) {
          values[0] = density(p, rt, rr);
          if (loss_ != nullptr) values[0] *= lost(directions(p, rt, rr));
        },
        beams_.of_receive_tube[piece.receive_tube], parts);
  }

  void add_weighed(const PlanarPolygon& polygon, const SharedPiece& piece, std::vector<Part>& parts) {
    const BeamPatterns& patterns = *law_.patterns;
    const auto [first, end] = patterns.beams_of_tube[piece.receive_tube];
    if (first == end) return;
    const TransmitPattern& transmit = patterns.transmit[patterns.fan_of_tube[piece.receive_tube]];
    work_.values = 1 + end - first;
    work_.resolution_rad = std::min(smooth_rad_, smooth_angle_);
    bool tables = false;
    for (const Directivity& sent : transmit.beams) {
      tables = tables || is_table(sent);
      for (std::uint32_t beam = first; beam < end; ++beam) {
        work_.resolution_rad = std::min(work_.resolution_rad, resolution_of(sent, patterns.receive[beam]));
        tables = tables || is_table(patterns.receive[beam]);
      }
    }
    refine(cornered_, tables);
    integrate(
        polygon,
        [&, first = first, end = end](glm::dvec2 p, double rt, double rr, std::span<double> values) {
          const Directions from = directions(p, rt, rr);
          values[0] = density(p, rt, rr);
          if (loss_ != nullptr) values[0] *= lost(from);
          const double sent = values[0] * transmit.gain(from.from_transmitter);
          for (std::uint32_t beam = first; beam < end; ++beam)
            values[1 + beam - first] = sent * patterns.receive[beam].gain(from.from_receiver);
        },
        first, parts);
  }

  static constexpr int most_refinements_with_tables = 12;
  static constexpr double tolerance_with_corners = 1e-6;
  /// Below this, cells are halved where the loss asks for it.
  static constexpr double least_smooth_angle = 1e-3;

  const BistaticHistory& history_;
  const BistaticBeams& beams_;
  const EchoLaw& law_;
  const PathLoss* loss_;
  double smooth_angle_ = 1;
  std::span<const double> borders_;
  PathCutter cutter_;
  double beta_;  // of the path there and back, each
  double tolerance_;
  PathCutter::Work work_;
  PathCutter::Receiver receiver_;
  FacetPlane plane_;
  PlaneFrame frame_{FacetPlane{}};
  glm::dvec3 transmit_down_{0}, receive_down_{0};  // from the apexes to the plane
  const PairedFacet* paired_ = nullptr;
  double factor_ = 0, own_ = 1;  // of Lambert's law; of any
  const ScatteringLaw* scattering_ = nullptr;
  double smooth_rad_ = 1;
  bool cornered_ = false;
  PlanarPolygon polygon_;
  const ReflectivityField* texture_ = nullptr;
  LyingPlane lies_;
  TextureCells cells_;
  std::vector<double> sum_;  // all 0 between pieces
};

}  // namespace

BistaticHistory trace_bistatic(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                               const VisibilityOptions& options, TubeSet transmit, TubeSet receive) {
  check_exact(options);
  BistaticHistory history{std::move(transmit), std::move(receive), grid_unit_m, {}};
  const auto sent = look(mesh, tree, history.transmit, options),
             heard = look(mesh, tree, history.receive, options);
  share(FootprintSharer(mesh, {history.transmit, sent}, {history.receive, heard}, grid_unit_m),
        history.shared);
  return history;
}

BistaticHistory trace_bistatic(const ApparentPair& pair, const WorldGrid& grid,
                               const VisibilityOptions& options, TubeSet transmit, TubeSet receive,
                               const Straightening& transmit_water, const Straightening& receive_water,
                               double reference_absorption_db_per_m) {
  check_exact(options);
  BistaticHistory history{std::move(transmit), std::move(receive), grid.unit_m(), {}};
  const FacetMesh &sent_to = pair.transmit.refined.mesh, &heard_from = pair.receive.refined.mesh;
  const SceneTree sent_tree(sent_to, SceneTree::Sheets::ignored),
      heard_tree(heard_from, SceneTree::Sheets::ignored);
  const auto sent = look(sent_to, sent_tree, history.transmit, options),
             heard = look(heard_from, heard_tree, history.receive, options);
  share(FootprintSharer({history.transmit, sent, &sent_to, pair.transmit_origin},
                        {history.receive, heard, &heard_from, pair.receive_origin}, grid.unit_m()),
        history.shared);
  history.paired =
      paired_facets(history.shared, pair, grid, transmit_water, receive_water, reference_absorption_db_per_m);
  return history;
}

Echo integrate_bistatic_echo(const BistaticHistory& history, const BistaticBeams& beams,
                             const RangeSamples& samples, const EchoLaw& law, double tolerance,
                             const PathLoss* loss) {
  check(history, beams, law, tolerance);
  const std::vector<double> borders = borders_of(samples);
  Echo echo;
  echo.beams = beams.count;
  echo.samples = samples.count;
  echo.energy.assign(std::size_t(beams.count) * samples.count, 0);

  const auto& facets = history.shared.facets;
  std::vector<std::vector<FacetEcho::Part>> parts(tasks_for(facets.size()));
  tbb::enumerable_thread_specific<FacetEcho> threads(
      [&] { return FacetEcho(history, beams, borders, law, tolerance, loss); });
  Steps steps("facets", facets.size());
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t task) {
    FacetEcho& facet_echo = threads.local();
    const std::size_t end = std::min((task + 1) * facets_per_task, facets.size());
    for (std::size_t k = task * facets_per_task; k < end; ++k) {
      facet_echo.add(k, parts[task]);
      steps.done();
    }
  });
  for (const auto& task : parts)
    for (const auto& [bin, energy] : task) echo.energy[bin] += energy;
  return echo;
}

}  // namespace tubefoot
