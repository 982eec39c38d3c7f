// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/gradient/moving_corner.hpp"

#include "geometry/mesh/facet_cone.hpp"

namespace tubefoot {
namespace {

MovingVector product(const MovingBall& factor, const MovingVector& v) {
  return {factor * v[0], factor * v[1], factor * v[2]};
}
MovingVector difference(const MovingVector& a, const MovingVector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
/// Only the square is known to be positive, so the root needs no sign.
MovingBall root(const MovingBall& x) {
  const Ball value = root(x.at);
  return {value, x.by / (Ball(2) * value)};
}

}  // namespace

MovingVector MovingNames::point(PointId id) const {
  const GridPoint p = context_.point(id);
  const BallVector by = velocity_(id);
  return {MovingBall{Ball(p.x), by[0]}, MovingBall{Ball(p.y), by[1]}, MovingBall{Ball(p.z), by[2]}};
}

MovingNames::Plane MovingNames::plane(FacetId facet) const {
  FacetCone cone;
  FacetCone::make(context_.mesh, facet, context_.apex, cone);
  const MovingVector first = point(cone.vertex[0]);
  const MovingVector normal =
      cross(difference(point(cone.vertex[1]), first), difference(point(cone.vertex[2]), first));
  return {normal, dot(normal, first)};
}

MovingNames::Plane MovingNames::unit_plane(FacetId facet) const {
  const Plane whole = plane(facet);
  const MovingBall per_length = MovingBall{Ball(1), Ball(0)} / root(dot(whole.normal, whole.normal));
  return {product(per_length, whole.normal), per_length * whole.offset};
}

MovingVector MovingNames::normal(const PlaneName& name) const {
  if (!name.depth) return cross(point(name.a), point(name.b));
  const Plane one = plane(name.a), other = plane(name.b);
  return difference(product(one.offset, other.normal), product(other.offset, one.normal));
}

MovingVector MovingNames::corner(const CornerName& corner, const Plane& plane) const {
  const MovingVector ray =
      corner.point != no_point ? point(corner.point) : cross(normal(corner.p), normal(corner.q));
  return product(plane.offset / dot(plane.normal, ray), ray);
}

}  // namespace tubefoot
