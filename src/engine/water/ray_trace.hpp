// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "engine/water/water_column.hpp"

namespace tubefoot {

/// Point of a ray in its vertical plane. Grazing angles are positive downwards.
struct RayState {
  double range_m = 0;  ///< horizontal, from the launch
  double depth_m = 0;
  double sine = 0, cosine = 1;  ///< of the grazing angle
  double time_s = 0;
  double length_m = 0;
  double absorption_db = 0;  ///< one way, along the path
  /// Area perpendicular to the ray per steradian at launch, in m^2/sr; 0 on a caustic.
  double tube_area_m2_per_sr = 0;
};

enum class RayEvent { launch, layer, surface, bottom, end };

/// Node of a ray: a border of layers, a reflection (with the state after it) or the end.
struct RayNode {
  RayEvent event = RayEvent::launch;
  RayState state;
  /// Depth at which the ray turned since the previous node.
  std::optional<double> turned_at_m{};
};

struct RayTraceOptions {
  /// Depth of a reflecting surface; minus infinity: no surface.
  double surface_m = -std::numeric_limits<double>::infinity();
  /// Depth of a flat reflecting bottom; infinity: no bottom.
  double bottom_m = std::numeric_limits<double>::infinity();
  double longest_range_m = 0;  ///< horizontal; the trace ends there
  /// Limit of nodes, because a nearly vertical ray between two reflectors is long.
  std::size_t most_nodes = 100'000;
  /// The trace ends with this reflection.
  std::size_t most_reflections = std::numeric_limits<std::size_t>::max();
};

/// Follows a ray through any number of layers as exact arcs, with turning points, and with reflections at
/// the surface and bottom of the options. The launch angle is in radians, positive down. The last node is an
/// `end` unless a limit of nodes or reflections is reached. Throws std::invalid_argument for a launch outside
/// of the water between surface and bottom, and for a vertical launch.
std::vector<RayNode> trace_ray(const WaterColumn& water, double launch_depth_m, double launch_rad,
                               const RayTraceOptions& options);

}  // namespace tubefoot
