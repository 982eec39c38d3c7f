// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec2.hpp>
#include <limits>
#include <numbers>

// Constants and functions on doubles that several modules use.
namespace tubefoot {

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180;  ///< in rad
constexpr double infinite = std::numeric_limits<double>::infinity();

/// Third component of the cross product of two vectors in a plane. It is positive if b lies to the left of a,
/// and twice the area of the triangle 0, a, b.
inline double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

}  // namespace tubefoot
