// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace tubefoot {

/// Of the grazing angle between a plane, by its normal of any length, and a direction of any length; 0 where
/// one of them has none.
inline double grazing_sine(const glm::dvec3& normal, const glm::dvec3& along) {
  const double length = glm::length(normal) * glm::length(along);
  return length > 0 ? std::abs(glm::dot(normal, along)) / length : 0;
}

}  // namespace tubefoot
