// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Exact_rational.h>

#include <array>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/numbers/exact_vector.hpp"

namespace tubefoot {

/// Constructs all values as rationals and settles no zero by names. Slow; the tests use it as reference.
/// Concept: arithmetic_fixed.hpp.
struct RationalArithmetic {
  static constexpr bool uses_names = false;
  static constexpr bool signs_are_exact = true;

  struct Facet {
    ExactVector n;
    CGAL::Exact_rational c;
  };
  struct Plane {
    ExactVector n;
  };
  struct Corner {
    ExactVector v;
  };

  void through(Plane& plane, GridPoint a, GridPoint b) const { plane.n = cross(exact(a), exact(b)); }
  void depth(Plane& plane, const Facet& i, const Facet& j) const {
    for (int k = 0; k < 3; ++k) plane.n[k] = i.c * j.n[k] - j.c * i.n[k];
  }
  void facet(Facet& f, const FacetCone& cone) const {
    const ExactVector a = exact(cone.point[0]);
    f.n = cross(difference(exact(cone.point[1]), a), difference(exact(cone.point[2]), a));
    f.c = dot(f.n, a);
  }
  void point(Corner& corner, GridPoint d) const { corner.v = exact(d); }
  void meet(Corner& corner, const Plane& p, const Plane& q, int sign) const {
    corner.v = cross(p.n, q.n);
    if (sign < 0)
      for (auto& x : corner.v) x = -x;
  }
  int side(const Corner& corner, const Plane& plane) const { return CGAL::sign(dot(corner.v, plane.n)); }
  int side(GridPoint p, const Plane& plane) const { return CGAL::sign(dot(exact(p), plane.n)); }
  int nearer(const Facet& f, GridPoint p) const {
    return CGAL::sign(CGAL::Exact_rational(f.c - dot(f.n, exact(p))));
  }
};

}  // namespace tubefoot
