// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/integrals/polar_slabs.hpp"
#include "geometry/numbers/ball.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot {

/// A visible piece in its facet's plane, every coordinate enclosed: from the exact integers that its corners'
/// names stand for, nothing rounded before. Metres.
struct CertifiedPolygon {
  struct Point {
    Ball x, y;  ///< along u and v from the foot point
  };
  struct Edge {
    Ball angle;     ///< of its direction in the plane, from u to v
    Ball height;    ///< of the foot point to the edge's left
    Ball nearest2;  ///< squared range of its line's nearest point
  };
  Ball distance;                   ///< of the apex from the plane
  std::array<Ball, 3> u, v, away;  ///< the plane's frame, pieces turning from u to v; away from the apex
  std::vector<Point> points;
  std::vector<Edge> edges;
  Ball perimeter;
  std::vector<EdgeRanges> ranges;      ///< by edge
  std::optional<RangeEnclosure> foot;  ///< see PolarSlabs::cut
  bool foot_inside = false;
};

/// The enclosure of a piece. `unit_m` is a power of two. An edge whose two corners cannot be resolved is
/// left out.
CertifiedPolygon certified_polygon(const NameContext& context, const std::vector<CornerName>& corners,
                                   const NamedPiece& piece, double unit_m);

/// The enclosure of a convex polygon on a facet whose corners were rounded: relative to the cone's apex,
/// metres, each coordinate off by at most 4 units in the last place of itself, or of itself relative to
/// `other_apex_m` and of that together (FootprintSharer). The facet's plane is exact.
CertifiedPolygon certified_polygon(const FacetCone& facet, std::span<const glm::dvec3> corners_m,
                                   glm::dvec3 other_apex_m, double unit_m);

/// A part of a polygon, in the same plane and turning the same way: all that follows from its points.
CertifiedPolygon part_of(const CertifiedPolygon& whole, std::vector<CertifiedPolygon::Point> points);

/// A convex polygon's points on the two sides of a line. `height` is each point's above the line: an affine
/// function of place. A point whose height is below `level` in magnitude is taken to be on the line, which
/// then passes through it: the two sides are one polygon cut along a chord, whatever the heights' roundings.
/// Either side is empty if no point is surely there.
std::array<std::vector<CertifiedPolygon::Point>, 2> split(const std::vector<CertifiedPolygon::Point>& points,
                                                          const std::vector<Ball>& height, double level);

}  // namespace tubefoot
