// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>

#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// A tube as the cone over the bilinear patch of its four unit corner rays. Corner 0 is at (u, v) = (0, 0), 1
/// at (1, 0), 2 at (1, 1) and 3 at (0, 1). The patch is doubly ruled, so lines of constant u or v are planes
/// through the apex. The cells of a (u, v) grid are tubes themselves, and their solid angles are closed
/// forms.
class RayPatch {
 public:
  RayPatch(const TubeSet& tubes, const Tube& tube);

  const std::array<glm::dvec3, 4>& corners() const { return corner_; }
  glm::dvec3 at(double u, double v) const { return p_ + u * pu_ + v * pv_ + (u * v) * puv_; }
  /// x . (dx/du x dx/dv), which is bilinear in u and v. Divided by |x|^3 it is the solid angle per du dv.
  double triple(double u, double v) const { return t_ + u * tu_ + v * tv_ + (u * v) * tuv_; }
  /// Returns the solid angle of the cell [u0, u1] x [v0, v1], exact except for rounding [sr].
  double solid_angle(double u0, double u1, double v0, double v1) const;
  /// Returns an upper bound of the solid angle per du dv.
  double density_bound() const;
  /// Returns whether the patch faces the apex everywhere. Otherwise directions have no unique (u, v).
  bool is_convex() const;

 private:
  std::array<glm::dvec3, 4> corner_;
  glm::dvec3 p_, pu_, pv_, puv_;
  double t_, tu_, tv_, tuv_;
};

}  // namespace tubefoot
