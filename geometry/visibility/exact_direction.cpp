// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/exact_direction.hpp"

#include <algorithm>

namespace tubefoot {

using Rational = CGAL::Exact_rational;

namespace {

ExactVector facet_plane(const FacetCone& cone, Rational& offset) {
  const ExactVector a = exact(cone.point[0]);
  const ExactVector n = cross(difference(exact(cone.point[1]), a), difference(exact(cone.point[2]), a));
  offset = dot(n, a);
  return n;
}

ExactVector normal_of(const NameContext& context, const PlaneName& name) {
  if (!name.depth) return cross(exact(context.point(name.a)), exact(context.point(name.b)));
  FacetCone i, j;
  FacetCone::make(context.mesh, name.a, context.apex, i);
  FacetCone::make(context.mesh, name.b, context.apex, j);
  Rational ci, cj;
  const ExactVector ni = facet_plane(i, ci), nj = facet_plane(j, cj);
  ExactVector m;
  for (int k = 0; k < 3; ++k) m[k] = ci * nj[k] - cj * ni[k];
  return m;
}

}  // namespace

ExactVector exact_direction(const NameContext& context, const CornerName& corner) {
  if (corner.point != no_point) return exact(context.point(corner.point));
  ExactVector d = cross(normal_of(context, corner.p), normal_of(context, corner.q));
  if (corner.sign < 0)
    for (Rational& x : d) x = -x;
  return d;
}

std::vector<ExactVector> exact_directions(const NameContext& context, const std::vector<CornerName>& corners,
                                          const NamedPiece& piece) {
  std::vector<ExactVector> directions(piece.count);
  for (std::uint32_t k = 0; k < piece.count; ++k)
    directions[k] = exact_direction(context, corners[piece.first + k]);
  return directions;
}

bool in_front(const ExactVector& axis, const std::vector<ExactVector>& directions) {
  return std::all_of(directions.begin(), directions.end(),
                     [&](const ExactVector& d) { return dot(axis, d) > 0; });
}

ExactVector gnomonic_axis(const TubeSet& tubes, std::uint32_t tube) {
  const Tube& rays = tubes.tubes.at(tube);
  ExactVector by_rays{0, 0, 0}, by_walls{0, 0, 0};
  for (int k = 0; k < 4; ++k) {
    const ExactVector d = exact(tubes.rays[rays[k]]), n = cross(d, exact(tubes.rays[rays[(k + 1) % 4]]));
    for (int c = 0; c < 3; ++c) {
      by_rays[c] += d[c];
      by_walls[c] += n[c];
    }
  }
  // The sum of the rays is the shorter vector, but a very wide tube may extend beyond 90 degrees from it. The
  // sum of the inward normals has every direction of the tube in front of it.
  for (const std::uint32_t ray : rays)
    if (dot(by_rays, exact(tubes.rays[ray])) <= 0) return by_walls;
  return by_rays;
}

Rational gnomonic_area(const ExactVector& axis, const std::vector<ExactVector>& directions) {
  std::vector<ExactVector> p(directions.size());
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Rational w = dot(axis, directions[k]);
    for (int c = 0; c < 3; ++c) p[k][c] = directions[k][c] / w;
  }
  Rational area = 0;
  for (std::size_t k = 1; k + 1 < p.size(); ++k) area += dot(p[0], cross(p[k], p[k + 1]));
  return area;
}

}  // namespace tubefoot
