// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <glm/vec3.hpp>

#include "geometry/numbers/ball.hpp"

// Vectors whose components are enclosed. Heavy: include only in .cpp files.
namespace tubefoot {

using BallVector = std::array<Ball, 3>;

inline BallVector balls(const glm::dvec3& p) { return {Ball(p.x), Ball(p.y), Ball(p.z)}; }
/// Encloses the difference of two points.
inline BallVector vector_between(const glm::dvec3& from, const glm::dvec3& to) {
  return {Ball(to.x) - Ball(from.x), Ball(to.y) - Ball(from.y), Ball(to.z) - Ball(from.z)};
}
inline Ball dot(const BallVector& a, const BallVector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline BallVector cross(const BallVector& a, const BallVector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Upper bound of the distance from `middle` to the points of a ball.
inline double radius_about(const Ball& ball, double middle) {
  return std::max(ball.hi() - middle, middle - ball.lo()) * (1 + 1e-15);
}

}  // namespace tubefoot
