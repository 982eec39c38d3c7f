// SPDX-License-Identifier: GPL-3.0-or-later
#include "footprints/footprint_rationals.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "files/streamed_file.hpp"
#include "files/usage_error.hpp"
#include "footprints/footprint_table.hpp"
#include "geometry/mesh/facet_cone.hpp"
#include "geometry/steps/steps.hpp"
#include "geometry/visibility/exact_direction.hpp"
#include "run/abilities.hpp"

namespace tubefoot {
namespace {

using Rational = CGAL::Exact_rational;

/// Tubes whose lines are held in memory together.
constexpr std::size_t tubes_a_block = 256;

std::string text(const Rational& value) { return value.str(); }

std::string text(const ExactVector& v) {
  return fmt::format(" {} {} {}", text(v[0]), text(v[1]), text(v[2]));
}

/// A double is a rational.
ExactVector exact_metres(glm::dvec3 p) { return {Rational(p.x), Rational(p.y), Rational(p.z)}; }

struct ShotLines {
  const ShotGround& ground;
  const TubeSet& tubes;
  ExactVector apex_m;
  Rational unit_m;

  void piece(const NameContext& context, const TubeVisibility& seen, const NamedPiece& piece,
             std::string& lines) const {
    FacetCone cone;
    FacetCone::make(ground.mesh(), piece.facet, tubes.apex, cone);
    const ExactVector a = exact(cone.point[0]);
    const ExactVector normal =
        cross(difference(exact(cone.point[1]), a), difference(exact(cone.point[2]), a));
    const Rational offset = dot(normal, a);
    lines += fmt::format("piece {} {}", ground.number_of(piece.facet), piece.count);
    for (const ExactVector& d : exact_directions(context, seen.corners, piece)) {
      const Rational along = Rational(unit_m * offset / dot(normal, d));
      ExactVector point;
      for (std::size_t k = 0; k < 3; ++k) point[k] = apex_m[k] + along * d[k];
      lines += text(point);
    }
    lines += '\n';
  }
  void open(const NameContext& context, const TubeVisibility& seen, const NamedPiece& piece,
            std::string& lines) const {
    lines += fmt::format("open {}", piece.count);
    for (const ExactVector& d : exact_directions(context, seen.corners, piece)) lines += text(d);
    lines += '\n';
  }
};

}  // namespace

struct RationalsFile::State {
  StreamedFile file;
  std::size_t sensor;
  tbb::enumerable_thread_specific<VisibilityScratch> threads;

  void write(const std::string& lines) { file.append(lines); }
};

RationalsFile::RationalsFile(const std::filesystem::path& file, const Shots& shots, std::size_t sensor) {
  require_able(shots.survey(), shots.request(), Feature::exact_corners, sensor);
  state_.reset(new State{StreamedFile(file), sensor, {}});
  state_->write(fmt::format(
      "# tubefoot exact footprints, version 1\n"
      "# shot PING SHOT APEX; tube NUMBER BEAM AXIS RAY RAY RAY RAY; piece FACET N POINT...; open "
      "N DIRECTION...\n"
      "# points: metres east, north and up in the local frame; axes, rays and directions: "
      "integers of any length\nsensor {}\n",
      shots.survey().sensors[sensor].sensor->description().name));
}

RationalsFile::~RationalsFile() = default;

std::size_t RationalsFile::add(const Shot& shot, std::span<const std::uint32_t> beams) {
  State& s = *state_;
  const Scene& scene = shot.scene();
  const ChosenTubes chosen = chosen_tubes(shot, s.sensor, beams);
  if (chosen.number.empty()) return 0;
  const std::vector<std::uint32_t>& beam_of_tube = shot.sensor(s.sensor).beam_of_tube(shot.number());
  const std::vector<std::uint32_t>& beams_of_shot = shot.sensor(s.sensor).beams_of_shot(shot.number());
  const ShotGround& ground = shot.ground();
  VisibilityOptions options = shot.request().visibility;
  options.open_water = true;
  const ShotLines lines{ground, chosen.set, exact_metres(scene.grid.to_metres(chosen.set.apex)),
                        Rational(scene.grid.unit_m())};
  s.write(fmt::format("shot {} {}{}\n", shot.ping(), shot.number(), text(lines.apex_m)));
  std::size_t pieces = 0;
  Steps steps("tubes", chosen.number.size());
  for (std::size_t begin = 0; begin < chosen.number.size(); begin += tubes_a_block) {
    const std::size_t end = std::min(begin + tubes_a_block, chosen.number.size());
    std::vector<std::string> of_tube(end - begin);
    std::vector<std::size_t> count(end - begin);
    tbb::parallel_for(begin, end, [&](std::size_t tube) {
      const auto t = static_cast<std::uint32_t>(tube);
      TubeVisibility seen;
      see(ground.mesh(), ground.tree(), chosen.set, t, options, s.threads.local(), seen);
      const NameContext context{ground.mesh(), chosen.set.apex, seen.rays};
      steps.done();
      std::string& out = of_tube[tube - begin];
      out = fmt::format("tube {} {}{}", chosen.number[tube], beams_of_shot[beam_of_tube[chosen.number[tube]]],
                        text(gnomonic_axis(chosen.set, t)));
      for (const std::uint32_t ray : chosen.set.tubes[tube]) out += text(exact(chosen.set.rays[ray]));
      out += '\n';
      for (const NamedPiece& piece : seen.pieces) {
        stop_if_wanted();
        lines.piece(context, seen, piece, out);
      }
      for (const NamedPiece& piece : seen.open) {
        stop_if_wanted();
        lines.open(context, seen, piece, out);
      }
      count[tube - begin] = seen.pieces.size();
    });
    for (std::size_t k = 0; k < of_tube.size(); ++k) {
      s.write(of_tube[k]);
      pieces += count[k];
    }
  }
  return pieces;
}

void RationalsFile::close() { state_->file.close(); }

}  // namespace tubefoot
