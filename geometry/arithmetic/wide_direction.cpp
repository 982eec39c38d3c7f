// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/arithmetic/wide_direction.hpp"

namespace tubefoot {

WideVec wide_normal(const NameContext& context, const PlaneName& plane) {
  if (!plane.depth) return widen(cross(context.point(plane.a), context.point(plane.b)));
  FacetCone i, j;
  FacetCone::make(context.mesh, plane.a, context.apex, i);
  FacetCone::make(context.mesh, plane.b, context.apex, j);
  return depth_normal(i, j);
}

WideVec wide_direction(const NameContext& context, const CornerName& corner) {
  if (corner.point != no_point) {
    const GridPoint d = context.point(corner.point);
    return {WideInt(d.x), WideInt(d.y), WideInt(d.z)};
  }
  WideVec d = cross(wide_normal(context, corner.p), wide_normal(context, corner.q));
  if (corner.sign < 0)
    for (WideInt& x : d) x = -x;
  return d;
}

}  // namespace tubefoot
