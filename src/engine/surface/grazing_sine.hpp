// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace tubefoot {

/// Returns the sine of the grazing angle between a plane, given by its normal, and a direction. Both vectors
/// may have any length. The result is 0 if one of them has length 0.
inline double grazing_sine(const glm::dvec3& normal, const glm::dvec3& along) {
  const double length = glm::length(normal) * glm::length(along);
  return length > 0 ? std::abs(glm::dot(normal, along)) / length : 0;
}

}  // namespace tubefoot
