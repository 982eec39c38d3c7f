// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/arithmetic/arithmetic_filtered.hpp"

#include <array>

namespace tubefoot {
namespace {

using CGAL::Mpzf;
using MpzfVec = std::array<Mpzf, 3>;

// Mpzf computes exponents and limbs with integer operations. Its construction from a double depends only on
// the double, so the caller's rounding mode has no effect here.
MpzfVec exact(GridPoint p) { return {Mpzf(p.x), Mpzf(p.y), Mpzf(p.z)}; }

MpzfVec cross(const MpzfVec& a, const MpzfVec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Mpzf dot(const MpzfVec& a, const MpzfVec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

MpzfVec normal(const FacetCone& cone) {
  const MpzfVec a = exact(cone.point[0]), b = exact(cone.point[1]), c = exact(cone.point[2]);
  return cross({b[0] - a[0], b[1] - a[1], b[2] - a[2]}, {c[0] - a[0], c[1] - a[1], c[2] - a[2]});
}

MpzfVec normal(const FilteredArithmetic::Plane& plane) {
  if (!plane.i) return cross(exact(plane.a), exact(plane.b));
  const MpzfVec ni = normal(*plane.i), nj = normal(*plane.j);
  const Mpzf ci = dot(ni, exact(plane.i->point[0])), cj = dot(nj, exact(plane.j->point[0]));
  return {ci * nj[0] - cj * ni[0], ci * nj[1] - cj * ni[1], ci * nj[2] - cj * ni[2]};
}

}  // namespace

int FilteredArithmetic::exact_side(const Corner& corner, const Plane& plane) {
  if (!corner.p) return exact_side(corner.point, plane);
  return corner.sign * CGAL::sign(dot(cross(normal(*corner.p), normal(*corner.q)), normal(plane)));
}

int FilteredArithmetic::exact_side(GridPoint p, const Plane& plane) {
  return CGAL::sign(dot(exact(p), normal(plane)));
}

int FilteredArithmetic::exact_nearer(const Facet& f, GridPoint p) {
  const MpzfVec n = normal(*f.cone);
  return CGAL::sign(dot(n, exact(f.cone->point[0])) - dot(n, exact(p)));
}

}  // namespace tubefoot
