// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "scene/description/scene_description.hpp"

// What the sensor models share: the axes of a sensor's frame and the cutting of a sector into tubes.
namespace tubefoot {

inline constexpr glm::dvec3 starboard_axis{1, 0, 0}, forward_axis{0, 1, 0}, up_axis{0, 0, 1};

inline constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180; }
inline constexpr double degrees(double radians) { return radians * 180 / std::numbers::pi; }

/// Widest slice of a sector about its axis. A beam is bounded by cones of constant elevation e, a tube by the
/// plane through two corner rays. Between rays that are w apart in azimuth this plane rises to an elevation
/// e' with tan e' = tan(corner) / cos(w / 2). With corners a little inside of the cone (height_of_corners)
/// tan e' is off by tan^2(w / 4) = w^2 / 16 of tan e, low at the slice's sides and high in its middle; this
/// is the width at which that is the tolerance. The solid angle gains a third of it.
inline double slice_width_rad(double tolerance) { return 4 * std::atan(std::sqrt(tolerance)); }

/// Equal slices that keep to the tolerance; a rounding above a whole number makes no further slice.
inline int slices_for(double width_rad, double tolerance) {
  return std::max(1, static_cast<int>(std::ceil(width_rad / slice_width_rad(tolerance) - 1e-9)));
}

/// Elevation of the corner rays of slices that stand for a cone: on it, where the middles keep to the
/// tolerance all the same.
inline double height_of_corners(double cone_rad, double slice_rad, double tolerance) {
  const double middle = std::cos(slice_rad / 2);
  if (1 / middle - 1 <= tolerance) return cone_rad;
  return std::atan(std::tan(cone_rad) * 2 * middle / (1 + middle));
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
