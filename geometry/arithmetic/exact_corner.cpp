// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/arithmetic/exact_corner.hpp"

namespace tubefoot {
namespace {

Vec64 normal_of(const NameContext& context, const PlaneName& name) {
  return cross(context.point(name.a), context.point(name.b));
}

WideVec wide_normal_of(const NameContext& context, const PlaneName& name) {
  if (!name.depth) return widen(normal_of(context, name));
  FacetCone i, j;
  FacetCone::make(context.mesh, name.a, context.apex, i);
  FacetCone::make(context.mesh, name.b, context.apex, j);
  return depth_normal(i, j);
}

}  // namespace

WideVec wide_direction(const NameContext& context, const CornerName& corner) {
  if (corner.point != no_point) {
    const GridPoint d = context.point(corner.point);
    return {WideInt(d.x), WideInt(d.y), WideInt(d.z)};
  }
  WideVec d = cross(wide_normal_of(context, corner.p), wide_normal_of(context, corner.q));
  if (corner.sign < 0)
    for (WideInt& x : d) x = -x;
  return d;
}

glm::dvec3 point_on_facet(const NameContext& context, const CornerName& corner, const FacetCone& facet) {
  const double offset = static_cast<double>(facet.offset);
  if (corner.point != no_point) {
    const GridPoint d = context.point(corner.point);
    const glm::dvec3 direction(d.x, d.y, d.z);
    if (!(corner.point & ray_bit))
      for (const VertexId v : facet.vertex)
        if (v == corner.point) return direction;
    return direction * (offset / static_cast<double>(dot(facet.normal, d)));
  }
  if (!corner.p.depth && !corner.q.depth) {
    const Vec64 a = normal_of(context, corner.p), b = normal_of(context, corner.q);
    const Int128 x = Int128(a.y) * b.z - Int128(a.z) * b.y, y = Int128(a.z) * b.x - Int128(a.x) * b.z,
                 z = Int128(a.x) * b.y - Int128(a.y) * b.x;
    Int192 along = multiply(x, facet.normal.x);
    along += multiply(y, facet.normal.y);
    along += multiply(z, facet.normal.z);
    return glm::dvec3(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)) *
           (offset / along.to_double());
  }
  const WideVec d = cross(wide_normal_of(context, corner.p), wide_normal_of(context, corner.q));
  const WideInt along = dot(d, widen(facet.normal));
  return glm::dvec3(d[0].convert_to<double>(), d[1].convert_to<double>(), d[2].convert_to<double>()) *
         (offset / along.convert_to<double>());
}

}  // namespace tubefoot
