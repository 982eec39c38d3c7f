// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/water/ray_trace.hpp"

namespace tubefoot {

/// Point of a ray's path. A node has its event; points inside an arc have none.
struct PathPoint {
  const RayNode* node = nullptr;
  double range_m = 0, depth_m = 0, angle_rad = 0;  ///< positive downwards
  double time_s = 0, length_m = 0, absorption_db = 0;
};

/// Returns the nodes of a traced ray, and between them points on the arcs, at most `step_rad` of direction
/// apart. The arcs follow from their ends. Along an arc, the length is proportional to the angle, and the
/// range to the sine. The time follows from d(artanh(sine)) / dt = -g for the gradient g. The points refer to
/// `nodes`.
std::vector<PathPoint> points_along(const std::vector<RayNode>& nodes, double step_rad);

}  // namespace tubefoot
