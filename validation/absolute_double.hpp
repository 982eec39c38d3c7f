// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "geometry/mesh/facet_cone.hpp"

namespace tubefoot::atlas {

/// Double arithmetic of an engine that subtracts no origin. Points are absolute coordinates in metres, and
/// planes are n . x = c in these coordinates. (Concept: geometry/arithmetic/arithmetic_fixed.hpp.) Rays and
/// constructed corners are points at `arm_m` from the apex along their direction. This distance is about that
/// of the scene.
struct AbsoluteDouble {
  static constexpr bool uses_names = true, signs_are_exact = false;
  double tolerance = 0;
  glm::dvec3 apex_m{0};
  double unit_m = 1, arm_m = 10;

  struct Plane {
    glm::dvec3 n;
    double c;
  };
  using Facet = Plane;
  struct Corner {
    glm::dvec3 x;
  };

  void through(Plane& plane, GridPoint a, GridPoint b) const {
    plane.n = glm::cross(at(a) - apex_m, at(b) - apex_m);
    plane.c = glm::dot(plane.n, apex_m);
  }
  void depth(Plane& plane, const Facet& i, const Facet& j) const {
    plane.n = (i.c - glm::dot(i.n, apex_m)) * j.n - (j.c - glm::dot(j.n, apex_m)) * i.n;
    plane.c = glm::dot(plane.n, apex_m);
  }
  void facet(Facet& f, const FacetCone& cone) const {
    const glm::dvec3 a = at(cone.point[0]);
    f.n = glm::cross(at(cone.point[1]) - a, at(cone.point[2]) - a);
    f.c = glm::dot(f.n, a);
  }
  void point(Corner& corner, GridPoint d) const { corner.x = at(d); }
  void meet(Corner& corner, const Plane& p, const Plane& q, int sign) const {
    const glm::dvec3 d = glm::cross(p.n, q.n);
    const double length = glm::length(d);
    corner.x = length > 0 ? apex_m + d * (sign * arm_m / length) : apex_m;
  }
  int side(const Corner& corner, const Plane& plane) const { return signum(plane, corner.x); }
  int side(GridPoint p, const Plane& plane) const { return signum(plane, at(p)); }
  int nearer(const Facet& f, GridPoint p) const { return -signum(f, at(p)); }

 private:
  glm::dvec3 at(GridPoint p) const { return apex_m + unit_m * glm::dvec3(p.x, p.y, p.z); }
  int signum(const Plane& plane, glm::dvec3 x) const {
    const double d = glm::dot(plane.n, x) - plane.c;
    const double zero = tolerance * glm::length(plane.n) * glm::length(x - apex_m);
    return d > zero ? 1 : d < -zero ? -1 : 0;
  }
};

}  // namespace tubefoot::atlas
