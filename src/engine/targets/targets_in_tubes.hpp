// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/targets/target_draws.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/search/scene_tree.hpp"

namespace tubefoot {

/// Calls `take` for each target in the tubes with the tubes that contain it, exactly (TubeWalls). The order
/// is that of the single targets and then of the populations. Targets beyond the reach may be left out; those
/// within the reach are not.
void each_target_in(const WaterTargets& targets, const TubeWalls& tubes, const WorldGrid& grid,
                    const TargetReach& reach, const TakeDraw& take);
/// Calls `take` for each target within the reach of an apex, in all directions and without tubes.
void each_target_about(const WaterTargets& targets, GridPoint apex, const WorldGrid& grid,
                       const TargetReach& reach, const TakeDraw& take);

/// Returns whether an apex sees a target, by exact predicates (line_of_sight.hpp). A facet hides a target if
/// the straight line to the target meets the facet or its border before it ends. A line that touches a
/// silhouette is therefore blocked.
///
/// Law X2 (occlusion): the result is that of rational arithmetic.
bool is_target_in_view(const FacetMesh& mesh, const SceneTree& tree, GridPoint apex, GridPoint target);

}  // namespace tubefoot
