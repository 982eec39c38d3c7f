// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>

#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// A tube as the cone over the bilinear patch of its four unit corner rays: corner 0 at (u, v) = (0, 0),
/// 1 at (1, 0), 2 at (1, 1), 3 at (0, 1). The patch is ruled both ways, so lines of constant u or v are
/// planes through the apex, cells of a (u, v) grid are tubes themselves, and their solid angles are closed
/// forms.
class RayPatch {
 public:
  RayPatch(const TubeSet& tubes, const Tube& tube);

  const std::array<glm::dvec3, 4>& corners() const { return corner_; }
  glm::dvec3 at(double u, double v) const { return p_ + u * pu_ + v * pv_ + (u * v) * puv_; }
  /// x . (dx/du x dx/dv), which is bilinear in u and v; over |x|^3 it is solid angle per du dv.
  double triple(double u, double v) const { return t_ + u * tu_ + v * tv_ + (u * v) * tuv_; }
  /// Solid angle of the cell [u0, u1] x [v0, v1], exact but for roundings [sr].
  double solid_angle(double u0, double u1, double v0, double v1) const;
  /// Largest solid angle per du dv, or a little more.
  double density_bound() const;
  /// Whether the patch turns its face to the apex everywhere: if not, directions have no (u, v) of their own.
  bool is_convex() const;

 private:
  std::array<glm::dvec3, 4> corner_;
  glm::dvec3 p_, pu_, pv_, puv_;
  double t_, tu_, tv_, tuv_;
};

}  // namespace tubefoot
