// SPDX-License-Identifier: GPL-3.0-or-later
#include "footprints/coverage_looks.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <numeric>

#include "geometry/steps/steps.hpp"
#include "run/shot_ends.hpp"

namespace tubefoot {
namespace {

/// What an end saw, as parts of the scene's facets.
std::shared_ptr<const PartedBed> bed_of(const ShotEnd& end) {
  if (end.refined == nullptr) return nullptr;
  auto bed = std::make_shared<PartedBed>();
  bed->mesh = end.refined->mesh;
  bed->tree = std::make_unique<const SceneTree>(bed->mesh, SceneTree::Sheets::ignored);
  bed->base = end.refined->parent;
  bed->weights = end.refined->weights;
  bed->name.resize(bed->base.size());
  for (FacetId f = 0; f < bed->name.size(); ++f) bed->name[f] = end.name_of(f);
  return bed;
}

CoverageEnd seen_by(const ShotEnd& end, std::shared_ptr<const PartedBed> bed,
                    const VisibilityOptions& options) {
  struct Buffers {
    VisibilityScratch visibility;
    TubeVisibility seen;
  };
  CoverageEnd result{end.tubes, std::vector<TubeVisibility>(end.tubes.tubes.size()), std::move(bed)};
  const std::vector<TubeRun> runs = runs_of(result.tubes);
  tbb::enumerable_thread_specific<Buffers> threads;
  Steps steps("tubes", result.tubes.tubes.size());
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t run) {
    auto& [scratch, sees] = threads.local();
    const TubeVisibility& seen = sees;  // a lambda may refer to it by this name
    see_run(*end.mesh, *end.tree, result.tubes, runs[run], options, scratch, sees, [&](std::uint32_t tube) {
      TubeVisibility& kept = result.seen[tube];  // copies are no larger than what they hold
      kept.corners = seen.corners;
      kept.pieces = seen.pieces;
      kept.rays = seen.rays;
      steps.done();
    });
  });
  return result;
}

}  // namespace

CoverageLook coverage_look(const Shot& shot, std::size_t sensor, std::uint32_t ping) {
  const ShotEnds ends(shot, sensor, true);
  const VisibilityOptions& options = shot.request().visibility;
  const auto bed = bed_of(ends.out());
  CoverageLook look{ping, seen_by(ends.out(), bed, options),
                    shot.sensor(sensor).samples().first_m / shot.scene().grid.unit_m(),
                    shot.sensor(sensor).reach(shot.scene().grid)};
  if (ends.are_two())
    look.home = seen_by(ends.home(), ends.apparent_pair() != nullptr ? bed_of(ends.home()) : bed, options);
  return look;
}

}  // namespace tubefoot
