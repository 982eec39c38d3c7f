// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/arithmetic/arithmetic_filtered.hpp"

#include <array>

#include "geometry/numbers/vector_products.hpp"

namespace tubefoot {
namespace {

using CGAL::Mpzf;
using MpzfVec = std::array<Mpzf, 3>;

// Mpzf computes exponents and limbs with integer operations. Its construction from a double depends only on
// the double, so the caller's rounding mode has no effect here.
MpzfVec mpzf(GridPoint p) { return {Mpzf(p.x), Mpzf(p.y), Mpzf(p.z)}; }

MpzfVec normal(const FacetCone& cone) {
  const MpzfVec a = mpzf(cone.point[0]), b = mpzf(cone.point[1]), c = mpzf(cone.point[2]);
  return cross(MpzfVec{b[0] - a[0], b[1] - a[1], b[2] - a[2]},
               MpzfVec{c[0] - a[0], c[1] - a[1], c[2] - a[2]});
}

MpzfVec normal(const FilteredArithmetic::Plane& plane) {
  if (!plane.i) return cross(mpzf(plane.a), mpzf(plane.b));
  const MpzfVec ni = normal(*plane.i), nj = normal(*plane.j);
  const Mpzf ci = dot(ni, mpzf(plane.i->point[0])), cj = dot(nj, mpzf(plane.j->point[0]));
  return {ci * nj[0] - cj * ni[0], ci * nj[1] - cj * ni[1], ci * nj[2] - cj * ni[2]};
}

}  // namespace

int FilteredArithmetic::exact_side(const Corner& corner, const Plane& plane) {
  if (!corner.p) return exact_side(corner.point, plane);
  return corner.sign * CGAL::sign(dot(cross(normal(*corner.p), normal(*corner.q)), normal(plane)));
}

int FilteredArithmetic::exact_side(GridPoint p, const Plane& plane) {
  return CGAL::sign(dot(mpzf(p), normal(plane)));
}

int FilteredArithmetic::exact_nearer(const Facet& f, GridPoint p) {
  const MpzfVec n = normal(*f.cone);
  return CGAL::sign(dot(n, mpzf(f.cone->point[0])) - dot(n, mpzf(p)));
}

}  // namespace tubefoot
