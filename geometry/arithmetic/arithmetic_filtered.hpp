// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Interval_nt.h>
#include <CGAL/Mpzf.h>

#include "geometry/mesh/facet_cone.hpp"

// Exact signs of the visibility predicates by CGAL's method: interval arithmetic first, then exact
// multi-precision numbers (Mpzf) where an interval contains 0.

namespace tubefoot {

/// Arithmetic with intervals first and Mpzf second, as CGAL does. The caller holds one `Guard` of the
/// rounding mode per tube. Exact for all input coordinates that a double represents; here the input
/// coordinates are those of the grid. Concept: arithmetic_fixed.hpp.
struct FilteredArithmetic {
  static constexpr bool uses_names = true;
  static constexpr bool signs_are_exact = true;
  using Interval = CGAL::Interval_nt_advanced;
  using Guard = CGAL::Protect_FPU_rounding<true>;

  struct Facet {
    const FacetCone* cone = nullptr;
    Interval n[3], c;
  };
  struct Plane {
    Interval n[3];
    GridPoint a, b;                              ///< for planes through two points
    const FacetCone *i = nullptr, *j = nullptr;  ///< for depth planes
  };
  struct Corner {
    Interval v[3];
    const Plane *p = nullptr, *q = nullptr;
    GridPoint point;
    int sign = 1;
  };

  void through(Plane& plane, GridPoint a, GridPoint b) const {
    const Interval ax = a.x, ay = a.y, az = a.z, bx = b.x, by = b.y, bz = b.z;
    plane.n[0] = ay * bz - az * by;
    plane.n[1] = az * bx - ax * bz;
    plane.n[2] = ax * by - ay * bx;
    plane.a = a;
    plane.b = b;
    plane.i = plane.j = nullptr;
  }
  void depth(Plane& plane, const Facet& i, const Facet& j) const {
    for (int k = 0; k < 3; ++k) plane.n[k] = i.c * j.n[k] - j.c * i.n[k];
    plane.i = i.cone;
    plane.j = j.cone;
  }
  void facet(Facet& f, const FacetCone& cone) const {
    f.cone = &cone;
    const auto& [a, b, c] = cone.point;
    const Interval p[3] = {double(b.x) - a.x, double(b.y) - a.y, double(b.z) - a.z};
    const Interval q[3] = {double(c.x) - a.x, double(c.y) - a.y, double(c.z) - a.z};
    f.n[0] = p[1] * q[2] - p[2] * q[1];
    f.n[1] = p[2] * q[0] - p[0] * q[2];
    f.n[2] = p[0] * q[1] - p[1] * q[0];
    f.c = f.n[0] * Interval(a.x) + f.n[1] * Interval(a.y) + f.n[2] * Interval(a.z);
  }
  void point(Corner& corner, GridPoint d) const {
    corner.v[0] = d.x;
    corner.v[1] = d.y;
    corner.v[2] = d.z;
    corner.p = corner.q = nullptr;
    corner.point = d;
    corner.sign = 1;
  }
  void meet(Corner& corner, const Plane& p, const Plane& q, int sign) const {
    corner.v[0] = p.n[1] * q.n[2] - p.n[2] * q.n[1];
    corner.v[1] = p.n[2] * q.n[0] - p.n[0] * q.n[2];
    corner.v[2] = p.n[0] * q.n[1] - p.n[1] * q.n[0];
    if (sign < 0)
      for (Interval& x : corner.v) x = -x;
    corner.p = &p;
    corner.q = &q;
    corner.sign = sign;
  }
  int side(const Corner& corner, const Plane& plane) const {
    const int s = interval_side(corner, plane);
    return s != 0 ? s : exact_side(corner, plane);
  }
  int side(GridPoint p, const Plane& plane) const {
    const int s = interval_side(p, plane);
    return s != 0 ? s : exact_side(p, plane);
  }
  int nearer(const Facet& f, GridPoint p) const {
    const int s = interval_nearer(f, p);
    return s != 0 ? s : exact_nearer(f, p);
  }

  /// The first stage: returns the sign if the interval excludes 0, otherwise 0.
  int interval_side(const Corner& corner, const Plane& plane) const {
    return certain(corner.v[0] * plane.n[0] + corner.v[1] * plane.n[1] + corner.v[2] * plane.n[2]);
  }
  int interval_side(GridPoint p, const Plane& plane) const {
    return certain(Interval(p.x) * plane.n[0] + Interval(p.y) * plane.n[1] + Interval(p.z) * plane.n[2]);
  }
  int interval_nearer(const Facet& f, GridPoint p) const {
    return certain(f.c - (Interval(p.x) * f.n[0] + Interval(p.y) * f.n[1] + Interval(p.z) * f.n[2]));
  }

  /// The second stage: returns the exact sign.
  static int exact_side(const Corner& corner, const Plane& plane);
  static int exact_side(GridPoint p, const Plane& plane);
  static int exact_nearer(const Facet& f, GridPoint p);

 private:
  static int certain(const Interval& d) { return d.inf() > 0 ? 1 : d.sup() < 0 ? -1 : 0; }
};

}  // namespace tubefoot
