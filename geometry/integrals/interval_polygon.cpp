// SPDX-License-Identifier: GPL-3.0-or-later
// Computes interval polygons: visible polygons in the planes of their facets, enclosed in intervals of long
// doubles. The computation is faster than that of certified_polygon.cpp and accurate to some 1e-18 of the
// range.

#include "geometry/integrals/interval_polygon.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "geometry/arithmetic/wide_direction.hpp"
#include "geometry/integrals/polar_numbers.hpp"
#include "geometry/numbers/vector_products.hpp"

namespace tubefoot {
namespace {

using FineVector = std::array<FineInterval, 3>;

FineVector fine(const Vec64& v) {
  return {FineInterval::of(v.x), FineInterval::of(v.y), FineInterval::of(v.z)};
}

FineVector scaled(const FineVector& a, const FineInterval& factor) {
  return {a[0] * factor, a[1] * factor, a[2] * factor};
}

/// Converts in two parts. The head is within two units in its last place (law W3), and the rest is exact
/// except for its own rounding.
FineInterval fine(const WideInt& x) {
  const auto head = x.convert_to<double>();
  const auto rest = WideInt(x - WideInt(head)).convert_to<double>();
  return FineInterval(head) + FineInterval(rest) * outwards(1 - 0x1p-50L, 1 + 0x1p-50L);
}

/// Direction of a corner's ray, up to its sign, and its component along the facet's normal, in which nothing
/// cancels.
std::pair<FineVector, FineInterval> ray_of(const NameContext& context, const CornerName& corner,
                                           const Vec64& normal) {
  if (corner.point != no_point) {
    const GridPoint d = context.point(corner.point);
    return {FineVector{FineInterval(double(d.x)), FineInterval(double(d.y)), FineInterval(double(d.z))},
            FineInterval::of(dot(normal, d))};
  }
  if (!corner.p.depth && !corner.q.depth) {
    const Vec64 a = cross(context.point(corner.p.a), context.point(corner.p.b)),
                b = cross(context.point(corner.q.a), context.point(corner.q.b));
    const Int128 x = Int128(a.y) * b.z - Int128(a.z) * b.y, y = Int128(a.z) * b.x - Int128(a.x) * b.z,
                 z = Int128(a.x) * b.y - Int128(a.y) * b.x;
    Int192 along = multiply(x, normal.x);
    along += multiply(y, normal.y);
    along += multiply(z, normal.z);
    return {FineVector{FineInterval::of(x), FineInterval::of(y), FineInterval::of(z)},
            FineInterval::of(along)};
  }
  const WideVec d = wide_direction(context, corner);
  return {FineVector{fine(d[0]), fine(d[1]), fine(d[2])}, fine(dot(d, widen(normal)))};
}

}  // namespace

Interval angle_of(const Interval& x, const Interval& y) {
  const double px = x.middle(), py = y.middle();
  // Largest distance of a point of the box from its middle, in doubles with a margin far above their
  // rounding.
  const double off = (std::max(x.hi - px, px - x.lo) + std::max(y.hi - py, py - y.lo)) * (1 + 1e-12);
  const double away = std::max(std::abs(px), std::abs(py));
  const double angle = std::atan2(py, px);
  // asin(z) <= pi / 2 z.
  const double turned = off < away ? 1.58 * off / away : std::numbers::pi * (1 + 1e-12);
  const double error = turned + library_units * 0x1p-52 * std::abs(angle);
  return outwards(angle - error, angle + error);
}

bool enclose_in_intervals(const NameContext& context, const std::vector<CornerName>& corners,
                          const NamedPiece& piece, double unit_m, IntervalPolygon& polygon) {
  FacetCone facet;
  FacetCone::make(context.mesh, piece.facet, context.apex, facet);
  const FineVector normal = fine(facet.normal);
  const GridPoint side = facet.point[1] - facet.point[0];
  const FineVector along{FineInterval(double(side.x)), FineInterval(double(side.y)),
                         FineInterval(double(side.z))};
  const FineInterval per_normal = FineInterval(1.0) / root(dot(normal, normal)),
                     per_along = FineInterval(1.0) / root(dot(along, along));
  const FineVector u = scaled(along, per_along), v = scaled(cross(normal, along), per_normal * per_along);
  const FineInterval offset = FineInterval::of(facet.offset) * FineInterval(unit_m);
  polygon.distance = offset * per_normal;
  polygon.points.clear();
  for (std::size_t i = 0; i < piece.count; ++i) {
    const auto [d, along_normal] = ray_of(context, corners[piece.first + i], facet.normal);
    const FineInterval stretch = offset / along_normal;
    polygon.points.push_back({dot(d, u) * stretch, dot(d, v) * stretch});
  }
  return finish<IntervalNumbers>(polygon);
}

}  // namespace tubefoot
