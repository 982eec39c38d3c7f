// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/integrals/polar_polygon.hpp"
#include "geometry/numbers/ball.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot {

/// A visible polygon in the plane of its facet, with every coordinate enclosed in a ball. The enclosures
/// follow from the exact integers that the corners' names denote, without earlier rounding. Lengths are in
/// metres.
struct CertifiedPolygon : PolarPolygon<Ball, Ball> {
  std::array<Ball, 3> u, v, away;  ///< frame of the plane; visible polygons turn from u to v; `away` points
                                   ///< away from the apex
};

/// Encloses a visible polygon. `unit_m` is a power of two. An edge whose two corners cannot be resolved is
/// omitted.
CertifiedPolygon certified_polygon(const NameContext& context, const std::vector<CornerName>& corners,
                                   const NamedPiece& piece, double unit_m);

/// Encloses a convex polygon on a facet whose corners were rounded. Corners are relative to the cone's apex,
/// in metres. The error of each coordinate is at most 4 units in the last place. These units are those of
/// the coordinate, or of its value relative to `other_apex_m` together with that apex (FootprintSharer). With
/// `rests_m` the corners are the sums of both, and their error is corner_rest_error. The plane of the facet
/// is exact.
CertifiedPolygon certified_polygon(const FacetCone& facet, std::span<const glm::dvec3> corners_m,
                                   std::span<const glm::dvec3> rests_m, glm::dvec3 other_apex_m,
                                   double unit_m);

/// Encloses a convex polygon whose corners are relative to the apex and lie on the plane of the points p with
/// dot(normal, p) = -distance_m. `normal` need not be a unit vector.
CertifiedPolygon certified_polygon(const glm::dvec3& normal, const Ball& distance_m,
                                   std::span<const std::array<Ball, 3>> corners_m);

/// Returns the corners of a polygon relative to the apex, and the exact directions of corners by name.
std::vector<std::array<Ball, 3>> corners_of(const CertifiedPolygon& polygon);
std::vector<std::array<Ball, 3>> directions_of(const NameContext& context,
                                               const std::vector<CornerName>& corners,
                                               const NamedPiece& piece);

/// A part of a polygon with these points, in the same plane and with the same orientation.
CertifiedPolygon part_of(const CertifiedPolygon& whole, std::vector<CertifiedPolygon::Point> points);
/// The same with corners relative to the apex.
CertifiedPolygon part_of(const CertifiedPolygon& whole, std::span<const std::array<Ball, 3>> corners_m);

/// Splits the points of a convex polygon by a line. `height` is the height of each point above the line, an
/// affine function of position. A point whose |height| is below `level` counts as a point of the line. The
/// two sides are then one polygon cut along a chord, whatever the rounding of the heights. A side is empty
/// if no point certainly lies there.
std::array<std::vector<CertifiedPolygon::Point>, 2> split(const std::vector<CertifiedPolygon::Point>& points,
                                                          const std::vector<Ball>& height, double level);

}  // namespace tubefoot
