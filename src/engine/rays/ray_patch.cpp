// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/rays/ray_patch.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tubefoot {
namespace {

double triple_product(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) { return glm::dot(a, glm::cross(b, c)); }

double arc_tangent(double y, double x) {
  const double t = y / x;
  // Cells are mostly small; the next term of the series is below 1e-17 of the sum.
  if (x > 0 && std::abs(t) < 4e-3) return t * (1 - t * t * (1.0 / 3 - t * t * (1.0 / 5 - t * t / 7)));
  return std::atan2(y, x);
}

/// Returns the solid angle of three unit directions. The triple product is computed from differences, which
/// is accurate for narrow cells.
double triangle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  return 2 *
         arc_tangent(triple_product(a, b - a, c - a), 1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
}

}  // namespace

RayPatch::RayPatch(const TubeSet& tubes, const Tube& tube) {
  for (int k = 0; k < 4; ++k) {
    const GridPoint& ray = tubes.rays.at(tube[k]);
    corner_[k] = glm::normalize(glm::dvec3(ray.x, ray.y, ray.z));
  }
  p_ = corner_[0];
  pu_ = corner_[1] - corner_[0];
  pv_ = corner_[3] - corner_[0];
  puv_ = (corner_[2] - corner_[3]) - pu_;
  // det(x, dx/du, dx/dv) = det(p - uv puv, pu + v puv, pv + u puv), expanded.
  t_ = triple_product(p_, pu_, pv_);
  tu_ = triple_product(p_, pu_, puv_);
  tv_ = triple_product(p_, puv_, pv_);
  tuv_ = -triple_product(puv_, pu_, pv_);
}

double RayPatch::solid_angle(double u0, double u1, double v0, double v1) const {
  const glm::dvec3 a = glm::normalize(at(u0, v0)), b = glm::normalize(at(u1, v0));
  const glm::dvec3 c = glm::normalize(at(u1, v1)), d = glm::normalize(at(u0, v1));
  return triangle(a, b, c) + triangle(a, c, d);
}

double RayPatch::density_bound() const {
  // The numerator is bilinear. |x| >= x . m for any unit m, and x . m is linear along both rulings.
  const glm::dvec3 middle = glm::normalize(at(0.5, 0.5));
  double largest = 0, shortest = 1;
  for (const double u : {0.0, 1.0})
    for (const double v : {0.0, 1.0}) {
      largest = std::max(largest, triple(u, v));
      shortest = std::min(shortest, glm::dot(at(u, v), middle));
    }
  return largest / (shortest * shortest * shortest);
}

bool RayPatch::is_convex() const {
  for (const double u : {0.0, 1.0})
    for (const double v : {0.0, 1.0})
      if (!(triple(u, v) >= 0)) return false;
  return solid_angle(0, 1, 0, 1) > 0;
}

}  // namespace tubefoot
