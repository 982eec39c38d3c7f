// SPDX-License-Identifier: GPL-3.0-or-later
// Computes certified polygons: visible polygons in the planes of their facets, with every coordinate
// enclosed in a ball. The computation starts from exact integers and rounds outwards once.

#include "geometry/integrals/certified_polygon.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <utility>

#include "geometry/arithmetic/integer_balls.hpp"
#include "geometry/arithmetic/wide_direction.hpp"
#include "geometry/footprints/shared_footprints.hpp"
#include "geometry/integrals/polar_numbers.hpp"
#include "geometry/numbers/ball_vector.hpp"

namespace tubefoot {
namespace {

BallVector scaled(const BallVector& a, const Ball& factor) {
  return {a[0] * factor, a[1] * factor, a[2] * factor};
}

/// Frame of the facet's plane, and the apex's distance from it.
CertifiedPolygon on_plane_of(const FacetCone& facet, double unit_m) {
  const WideVec normal = widen(facet.normal);
  const WideInt offset = widen(facet.offset);
  const GridPoint side = facet.point[1] - facet.point[0];
  const WideVec along{WideInt(side.x), WideInt(side.y), WideInt(side.z)};

  CertifiedPolygon polygon;
  const Ball per_normal = Ball(1) / root(ball(tubefoot::dot(normal, normal)));
  polygon.away = scaled(balls(normal), per_normal);
  const Ball per_along = Ball(1) / root(ball(tubefoot::dot(along, along)));
  polygon.u = scaled(balls(along), per_along);
  polygon.v = scaled(balls(cross(normal, along)), per_normal * per_along);
  polygon.distance = ball(offset) * per_normal * Ball(unit_m);
  return polygon;
}

}  // namespace

CertifiedPolygon certified_polygon(const NameContext& context, const std::vector<CornerName>& corners,
                                   const NamedPiece& piece, double unit_m) {
  FacetCone facet;
  FacetCone::make(context.mesh, piece.facet, context.apex, facet);
  const WideVec normal = widen(facet.normal);
  const WideInt offset = widen(facet.offset);
  CertifiedPolygon polygon = on_plane_of(facet, unit_m);

  const std::size_t n = piece.count;
  std::vector<CertifiedPolygon::Point>& points = polygon.points;
  points.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const WideVec d = wide_direction(context, corners[piece.first + i]);
    const BallVector p = scaled(balls(d), ball(offset) / ball(tubefoot::dot(d, normal)) * Ball(unit_m));
    points[i] = {dot(p, polygon.u), dot(p, polygon.v)};
  }
  finish<BallNumbers>(polygon);
  return polygon;
}

CertifiedPolygon certified_polygon(const FacetCone& facet, std::span<const glm::dvec3> corners_m,
                                   std::span<const glm::dvec3> rests_m, glm::dvec3 other_apex_m,
                                   double unit_m) {
  constexpr double four_units = 0x1p-50, rounding = 0x1p-52;
  CertifiedPolygon polygon = on_plane_of(facet, unit_m);
  for (std::size_t i = 0; i < corners_m.size(); ++i) {
    const glm::dvec3& corner = corners_m[i];
    BallVector p;
    for (int k = 0; k < 3; ++k) {
      const double sizes = std::abs(corner[k] - other_apex_m[k]) + std::abs(other_apex_m[k]),
                   error = rests_m.empty() ? four_units * sizes + rounding * std::abs(corner[k])
                                           : corner_rest_error * (sizes + std::abs(corner[k]));
      Ball& coordinate = p[std::size_t(k)];
      coordinate = Ball(corner[k]);
      if (!rests_m.empty()) coordinate += Ball(rests_m[i][k]);
      coordinate.add_error(Ball(error * (1 + 1e-9)));
    }
    polygon.points.push_back({dot(p, polygon.u), dot(p, polygon.v)});
  }
  finish<BallNumbers>(polygon);
  return polygon;
}

CertifiedPolygon certified_polygon(const glm::dvec3& normal, const Ball& distance_m,
                                   std::span<const BallVector> corners_m) {
  const BallVector towards_apex = balls(normal);
  const Ball per_length = Ball(1) / root(dot(towards_apex, towards_apex));
  CertifiedPolygon plane;
  plane.away = scaled(towards_apex, -per_length);
  plane.distance = distance_m * per_length;
  // The coordinate axis that is farthest from the normal makes the frame, with u x v = away.
  const glm::dvec3 size = glm::abs(normal);
  const std::size_t axis = size.x <= size.y && size.x <= size.z ? 0 : size.y <= size.z ? 1 : 2;
  BallVector along;
  along[axis] = Ball(1);
  const BallVector across = cross(along, plane.away);
  plane.u = scaled(across, Ball(1) / root(dot(across, across)));
  plane.v = cross(plane.away, plane.u);
  return part_of(plane, corners_m);
}

std::vector<BallVector> corners_of(const CertifiedPolygon& polygon) {
  std::vector<BallVector> corners;
  for (const CertifiedPolygon::Point& p : polygon.points) {
    BallVector& corner = corners.emplace_back();
    for (std::size_t k = 0; k < corner.size(); ++k)
      corner[k] = p.x * polygon.u[k] + p.y * polygon.v[k] + polygon.distance * polygon.away[k];
  }
  return corners;
}

std::vector<BallVector> directions_of(const NameContext& context, const std::vector<CornerName>& corners,
                                      const NamedPiece& piece) {
  std::vector<BallVector> directions;
  for (std::uint32_t k = 0; k < piece.count; ++k)
    directions.push_back(balls(wide_direction(context, corners[piece.first + k])));
  return directions;
}

CertifiedPolygon part_of(const CertifiedPolygon& whole, std::span<const BallVector> corners_m) {
  std::vector<CertifiedPolygon::Point> points;
  for (const BallVector& p : corners_m) points.push_back({dot(p, whole.u), dot(p, whole.v)});
  return part_of(whole, std::move(points));
}

CertifiedPolygon part_of(const CertifiedPolygon& whole, std::vector<CertifiedPolygon::Point> points) {
  CertifiedPolygon part;
  part.distance = whole.distance;
  part.u = whole.u;
  part.v = whole.v;
  part.away = whole.away;
  part.points = std::move(points);
  finish<BallNumbers>(part);
  return part;
}

std::array<std::vector<CertifiedPolygon::Point>, 2> split(const std::vector<CertifiedPolygon::Point>& points,
                                                          const std::vector<Ball>& height, double level) {
  std::vector<int> side;
  for (const Ball& h : height) side.push_back(h.lo() > level ? 1 : h.hi() < -level ? -1 : 0);
  std::array<std::vector<CertifiedPolygon::Point>, 2> parts;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t next = i + 1 == points.size() ? 0 : i + 1;
    if (side[i] <= 0) parts[0].push_back(points[i]);
    if (side[i] >= 0) parts[1].push_back(points[i]);
    if (side[i] * side[next] >= 0) continue;
    const Ball along = height[i] / (height[i] - height[next]);
    const CertifiedPolygon::Point cut{points[i].x + along * (points[next].x - points[i].x),
                                      points[i].y + along * (points[next].y - points[i].y)};
    for (auto& part : parts) part.push_back(cut);
  }
  for (const int which : {0, 1})
    if (std::find(side.begin(), side.end(), 2 * which - 1) == side.end()) parts[which].clear();
  return parts;
}

}  // namespace tubefoot
