// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/targets/targets_in_tubes.hpp"

#include <glm/geometric.hpp>
#include <vector>

#include "geometry/numbers/grid_vector.hpp"
#include "geometry/search/line_of_sight.hpp"

namespace tubefoot {
namespace {

/// Returns whether a target lies within the reach, up to rounding.
bool is_within(const WaterTarget& target, GridPoint apex, const WorldGrid& grid, const TargetReach& reach) {
  constexpr double rounding = 1e-12;
  const double range_m = glm::length(displacement_m(apex, target.at, grid.unit_m()));
  return range_m >= reach.nearest_m * (1 - rounding) && range_m <= reach.farthest_m * (1 + rounding);
}

}  // namespace

void each_target_in(const WaterTargets& targets, const TubeWalls& tubes, const WorldGrid& grid,
                    const TargetReach& reach, const TakeDraw& take) {
  std::vector<std::uint32_t> found;
  for (const WaterTarget& target : targets.single) {
    if (!is_within(target, tubes.apex(), grid, reach)) continue;
    tubes.find(target.at, found);
    if (!found.empty()) take(target, found);
  }
  for (const TargetPopulation& population : targets.populations)
    draw_targets(population, tubes.apex(), &tubes, grid, reach,
                 [&](const WaterTarget& target, std::span<const std::uint32_t> candidates) {
                   if (!is_within(target, tubes.apex(), grid, reach)) return;
                   found.clear();
                   for (const std::uint32_t tube : candidates)
                     if (tubes.contains(tube, target.at)) found.push_back(tube);
                   if (!found.empty()) take(target, found);
                 });
}

void each_target_about(const WaterTargets& targets, GridPoint apex, const WorldGrid& grid,
                       const TargetReach& reach, const TakeDraw& take) {
  for (const WaterTarget& target : targets.single)
    if (is_within(target, apex, grid, reach)) take(target, {});
  for (const TargetPopulation& population : targets.populations)
    draw_targets(population, apex, nullptr, grid, reach,
                 [&](const WaterTarget& target, std::span<const std::uint32_t>) {
                   if (is_within(target, apex, grid, reach)) take(target, {});
                 });
}

bool is_target_in_view(const FacetMesh& mesh, const SceneTree& tree, GridPoint apex, GridPoint target) {
  return in_view(mesh, tree, apex, target);
}

}  // namespace tubefoot
