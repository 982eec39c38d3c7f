// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/footprints/corner_rests.hpp"

#include <cstdint>

#include "geometry/arithmetic/integer_balls.hpp"
#include "geometry/arithmetic/wide_direction.hpp"

// Computes corners from the exact integers that define them, in balls of 128 bits. Each quotient has one
// rounding, so the rest of a double keeps about 70 bits.
namespace tubefoot {
namespace {

std::array<std::int64_t, 3> components(const Vec64& v) { return {v.x, v.y, v.z}; }
std::array<std::int64_t, 3> components(GridPoint p) { return {p.x, p.y, p.z}; }

}  // namespace

BallVector exact_point_on(const NameContext& context, const CornerName& corner, const FacetCone& facet) {
  const WideVec d = wide_direction(context, corner);
  const Ball scale = ball(widen(facet.offset)) / ball(dot(d, widen(facet.normal)));
  BallVector point = balls(d);
  for (Ball& coordinate : point) coordinate = coordinate * scale;
  return point;
}

BallVector exact_meeting_point(const FacetCone& facet, const FacetChart& chart, const PlaneLine& p,
                               const PlaneLine& q) {
  const auto [u, v, w] = chart;
  const HugeInt x = p.b * q.c - p.c * q.b, y = p.c * q.a - p.a * q.c, z = p.a * q.b - p.b * q.a;
  const auto n = components(facet.normal), vertex = components(facet.point[0]);
  const auto at = [](int axis) { return std::size_t(axis); };
  BallVector point;
  point[at(u)] = ball(HugeInt(x + vertex[at(u)] * z)) / ball(z);
  point[at(v)] = ball(HugeInt(y + vertex[at(v)] * z)) / ball(z);
  const HugeInt nz = n[at(w)] * z;
  point[at(w)] = ball(HugeInt(vertex[at(w)] * nz - n[at(u)] * x - n[at(v)] * y)) / ball(nz);
  return point;
}

BallVector moved(BallVector point, GridPoint to, GridPoint from) {
  const auto a = components(from), b = components(to);
  for (std::size_t k = 0; k < 3; ++k) point[k] += Ball(double(a[k] - b[k]));
  return point;
}

glm::dvec3 rest_m(const BallVector& exact, double unit_m, const glm::dvec3& rounded_m) {
  glm::dvec3 rest;
  for (int k = 0; k < 3; ++k) rest[k] = (exact[std::size_t(k)] * Ball(unit_m) - Ball(rounded_m[k])).middle();
  return rest;
}

/// Source: Knuth, The Art of Computer Programming, volume 2, section 4.2.2, theorem B.
glm::dvec3 rounding_of_difference(const glm::dvec3& a, const glm::dvec3& b) {
  glm::dvec3 rest;
  for (int k = 0; k < 3; ++k) {
    const double difference = a[k] - b[k], back = difference - a[k];
    rest[k] = (a[k] - (difference - back)) - (b[k] + back);
  }
  return rest;
}

}  // namespace tubefoot
