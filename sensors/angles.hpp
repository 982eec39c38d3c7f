// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "scene/scene_description.hpp"

// What the sensor models share: the axes of a sensor's frame and the cutting of a sector into tubes.
namespace tubefoot {

inline constexpr glm::dvec3 starboard_axis{1, 0, 0}, forward_axis{0, 1, 0}, up_axis{0, 0, 1};

inline constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180; }
inline constexpr double degrees(double radians) { return radians * 180 / std::numbers::pi; }

/// Widest slice of a sector about its axis. A beam is bounded by cones of constant elevation e, a tube by the
/// plane through two corner rays at +e. Half way between rays that are w apart in azimuth this plane lies at
/// the elevation e' with tan e' = tan e / cos(w / 2), so a beam comes out too wide by at most 1/cos(w/2) - 1
/// = w^2 / 8 of tan e. 1.6 degrees keep that to 9.75e-5 (2 degrees would make it 1.5e-4); the solid angle
/// gains w^2 / 12, 6.5e-5.
inline constexpr double slice_width_rad = radians(1.6);

/// Equal slices that keep to slice_width_rad; a rounding above a whole number makes no further slice.
inline int slices_for(double width_rad) {
  return std::max(1, static_cast<int>(std::ceil(width_rad / slice_width_rad - 1e-9)));
}

/// n + 1 edges of n equal cells; the last edge is exact.
inline std::vector<double> even_edges(double first, double last, int cells) {
  std::vector<double> edges;
  edges.reserve(static_cast<std::size_t>(cells) + 1);
  for (int k = 0; k < cells; ++k) edges.push_back(first + (last - first) * k / cells);
  edges.push_back(last);
  return edges;
}

/// Refuses a value that makes no sensor. Scene files are checked before, with line and column.
template <typename Value>
void require(bool holds, const SensorDescription& sensor, const char* key, Value value, const char* wanted) {
  if (!holds)
    throw std::invalid_argument(
        fmt::format("sensor '{}': {} is {}, must be {}", sensor.name, key, value, wanted));
}

}  // namespace tubefoot
