// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/arithmetic/arithmetic_fixed.hpp"

#include "geometry/arithmetic/wide_vector.hpp"

namespace tubefoot {
namespace {

WideVec wide_normal(const FixedArithmetic::Plane& plane) {
  return plane.i ? depth_normal(*plane.i, *plane.j) : widen(plane.exact);
}

}  // namespace

int FixedArithmetic::exact_side(const Corner& corner, const Plane& plane) {
  if (!corner.p) return exact_side(corner.point, plane);
  const Plane &p = *corner.p, &q = *corner.q;
  if (p.i || q.i || plane.i)
    return corner.sign * dot(cross(wide_normal(p), wide_normal(q)), wide_normal(plane)).sign();
  const Vec64 &a = p.exact, &b = q.exact, &c = plane.exact;
  Int192 sum = multiply(Int128(a.y) * b.z - Int128(a.z) * b.y, c.x);
  sum += multiply(Int128(a.z) * b.x - Int128(a.x) * b.z, c.y);
  sum += multiply(Int128(a.x) * b.y - Int128(a.y) * b.x, c.z);
  return corner.sign * sum.sign();
}

int FixedArithmetic::exact_side(GridPoint p, const Plane& plane) {
  if (!plane.i) return sign(dot(plane.exact, p));
  // c_i (n_j . p) - c_j (n_i . p): products of 94 and 94 bits.
  const WideInt towards_j = widen(plane.i->offset) * widen(dot(plane.j->normal, p)),
                towards_i = widen(plane.j->offset) * widen(dot(plane.i->normal, p));
  return WideInt(towards_j - towards_i).sign();
}

}  // namespace tubefoot
