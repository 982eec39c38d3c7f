// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <glm/vec3.hpp>

#include "geometry/numbers/ball.hpp"
#include "geometry/numbers/vector_products.hpp"

// Vectors whose components are enclosed. Heavy: include only in .cpp files.
namespace tubefoot {

using BallVector = std::array<Ball, 3>;

inline BallVector balls(const glm::dvec3& p) { return {Ball(p.x), Ball(p.y), Ball(p.z)}; }
/// Encloses the difference of two points.
inline BallVector vector_between(const glm::dvec3& from, const glm::dvec3& to) {
  return {Ball(to.x) - Ball(from.x), Ball(to.y) - Ball(from.y), Ball(to.z) - Ball(from.z)};
}
/// Products of the vectors (ax, ay) and (bx, by) in a plane.
inline Ball dot(const Ball& ax, const Ball& ay, const Ball& bx, const Ball& by) { return ax * bx + ay * by; }
inline Ball cross(const Ball& ax, const Ball& ay, const Ball& bx, const Ball& by) {
  return ax * by - ay * bx;
}

/// Upper bound of the distance from `middle` to the points of a ball.
inline double radius_about(const Ball& ball, double middle) {
  return std::max(ball.hi() - middle, middle - ball.lo()) * (1 + 1e-15);
}

}  // namespace tubefoot
