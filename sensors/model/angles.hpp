// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "scene/description/sensor_description.hpp"

// Common parts of the sensor models: the axes of a sensor's frame, and the division of a sector into tubes.
namespace tubefoot {

inline constexpr glm::dvec3 starboard_axis{1, 0, 0}, forward_axis{0, 1, 0}, up_axis{0, 0, 1};

inline constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180; }
inline constexpr double degrees(double radians) { return radians * 180 / std::numbers::pi; }

/// Largest width of a slice of a sector about its axis. Cones of constant elevation e bound a beam, while
/// the plane through two corner rays bounds a tube. Between rays of azimuth difference w this plane rises to
/// an elevation e' with tan e' = tan(corner) / cos(w / 2). With corners slightly inside of the cone
/// (height_of_corners) the error of tan e' is tan^2(w / 4) = w^2 / 16 of tan e. It is negative at the
/// slice's sides and positive in its middle. The result is the width at which the error equals the
/// tolerance. The solid angle increases by a third of it.
inline double slice_width_rad(double tolerance) { return 4 * std::atan(std::sqrt(tolerance)); }

/// Number of equal slices within the tolerance. Rounding slightly above a whole number adds no slice.
inline int slices_for(double width_rad, double tolerance) {
  return std::max(1, static_cast<int>(std::ceil(width_rad / slice_width_rad(tolerance) - 1e-9)));
}

/// Elevation of the corner rays of slices that approximate a cone. It is that of the cone if the middles
/// still satisfy the tolerance.
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

/// Throws std::invalid_argument for an invalid value. The reader of scene files checks values before, with
/// line and column.
template <typename Value>
void require(bool holds, const SensorDescription& sensor, const char* key, Value value, const char* wanted) {
  if (!holds)
    throw std::invalid_argument(
        fmt::format("sensor '{}': {} is {}, but must be {}", sensor.name, key, value, wanted));
}

}  // namespace tubefoot
