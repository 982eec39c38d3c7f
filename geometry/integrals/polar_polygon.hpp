// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "geometry/integrals/polar_slabs.hpp"

// A convex polygon in polar coordinates about the foot point of an apex, for any number type: intervals,
// balls and dual numbers (polar_numbers.hpp).
namespace tubefoot {

/// A visible polygon in the plane of its facet. `Fine` is the number type of coordinates and ranges, in which
/// digits cancel. `Number` is that of angles and heights. Lengths are in metres.
template <class FineType, class NumberType>
struct PolarPolygon {
  using Fine = FineType;
  using Number = NumberType;
  struct Point {
    Fine x, y;  ///< in the plane, from the foot point
  };
  struct Edge {
    Number angle;   ///< angle of the edge's direction in the plane, up to whole turns
    Number height;  ///< height of the foot point to the left of the edge
    Fine nearest2;  ///< squared range of the nearest point of the edge's line
  };
  Fine distance;  ///< of the apex from the plane
  std::vector<Point> points;
  std::vector<Edge> edges;
  Fine perimeter;
  std::vector<EdgeRanges> ranges;      ///< by edge
  std::optional<RangeEnclosure> foot;  ///< see PolarSlabs::cut
  bool foot_inside = false;
};

/// Computes edges and ranges from the distance and the points. An edge whose two corners cannot be resolved
/// is omitted. Returns whether there is no such edge.
template <class Numbers>
bool finish(PolarPolygon<typename Numbers::Fine, typename Numbers::Number>& polygon) {
  using Fine = typename Numbers::Fine;
  const auto& points = polygon.points;
  const std::size_t n = points.size();
  const Fine distance2 = squared(polygon.distance);
  polygon.edges.clear();
  polygon.ranges.clear();
  polygon.foot.reset();
  polygon.perimeter = Fine();
  const auto range_of = [&](const auto& p) {
    return Numbers::enclosure(root(distance2 + squared(p.x) + squared(p.y)));
  };
  const auto sign = [](const Fine& x) { return x.surely_positive() ? 1 : x.surely_negative() ? -1 : 0; };

  bool resolved = true, maybe_inside = true;
  polygon.foot_inside = true;
  const RangeEnclosure first = n == 0 ? RangeEnclosure() : range_of(points[0]);
  RangeEnclosure from = first;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = i + 1 == n ? 0 : i + 1;
    const RangeEnclosure begin = from, end = from = next == 0 ? first : range_of(points[next]);
    const Fine x = points[next].x - points[i].x, y = points[next].y - points[i].y;
    const Fine length = root(squared(x) + squared(y));
    polygon.perimeter += length;
    if (!length.surely_positive()) {
      resolved = false;
      continue;
    }
    const auto [ax, ay] = Numbers::direction(x, y, length);
    const Fine height = points[i].x * ay - points[i].y * ax, nearest2 = distance2 + squared(height);
    polygon.edges.push_back(
        {Numbers::angle_of(Numbers::number(ax), Numbers::number(ay)), Numbers::number(height), nearest2});
    polygon.ranges.push_back({begin, end, Numbers::enclosure(root(nearest2)),
                              sign(points[i].x * ax + points[i].y * ay),
                              sign(points[next].x * ax + points[next].y * ay)});
    polygon.foot_inside = polygon.foot_inside && height.surely_positive();
    maybe_inside = maybe_inside && !height.surely_negative();
  }
  if (maybe_inside) polygon.foot = Numbers::enclosure(polygon.distance);
  return resolved;
}

}  // namespace tubefoot
