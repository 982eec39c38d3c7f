// SPDX-License-Identifier: GPL-3.0-or-later
#include "footprints/coverage_looks.hpp"

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
  CoverageEnd result{end.tubes, look(*end.mesh, *end.tree, end.tubes, options), std::move(bed)};
  for (TubeVisibility& seen : result.seen) seen.occluders = {};  // many looks are kept
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
