// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/arithmetic/wide_vector.hpp"
#include "geometry/mesh/facet_cone.hpp"

// Represents convex polygons on a facet as cyclic lists of lines with integer coefficients. A corner is the
// intersection of two neighbouring lines and is not evaluated. The only predicate is the sign of a
// determinant of three lines.
namespace tubefoot {

/// Integers that hold all intermediate results. Numbers of bits:
/// - the direction of a corner: at most 314 (two depth planes of 156)
/// - a wall through two such directions: 630; nearly always the wall is one of their planes, with 61 or 156
/// - the coefficients of a line: 693, and 727 when multiplied by the facet's vertex
/// - a determinant of three lines: 2117
/// - the numerators of a corner: at most 1488
/// - lines of an image: at most 3 more per coefficient
/// - on a chart of weights of 45 bits (coverage.hpp): 710 and 755 for a line, 2180 for a determinant
using HugeInt = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<
    2304, 2304, boost::multiprecision::signed_magnitude, boost::multiprecision::unchecked, void>>;

/// Coordinates on a facet's plane: two of the three axes, u and v, relative to the facet's first vertex. They
/// are chosen so that a counter-clockwise turn about the facet's normal (FacetCone) is counter-clockwise on
/// the chart. Apexes on the same side of a facet have the same chart.
struct FacetChart {
  int u = 0, v = 1, w = 2;
  explicit FacetChart(const FacetCone& facet);
};

/// Positions of the corners of a facet on a chart, counter-clockwise.
using ChartCorners = std::array<std::array<std::int64_t, 2>, 3>;

/// Returns the inward normal of the wall from one direction to the next.
std::array<HugeInt, 3> wall_normal(const WideVec& from, const WideVec& to);

/// A half-plane a u + b v + c >= 0 of a facet.
struct PlaneLine {
  HugeInt a, b, c;
  /// The coefficients times a power of two that brings the larger of |a|, |b| to [1, 2). The relative error
  /// of each is at most 2^-52.
  double a_near = 0, b_near = 0, c_near = 0;

  /// Returns the half-plane on the inner side of the plane through the apex of `facet` with this inward
  /// normal, of at most 630 bits.
  static PlaneLine on_plane(const FacetCone& facet, const FacetChart& chart,
                            const std::array<HugeInt, 3>& normal);
  /// Intersects the plane through an apex with this inward normal (at most 630 bits) with a facet. `corners`
  /// are relative to the apex. The result is a line of a chart on which the corners have other positions: an
  /// image, or a part of another facet. The chart coordinates have n bits. Then a and b have 2 + n bits more
  /// than the distances of the corners from the plane, and c has 1 + 2 n more.
  static PlaneLine on_image(const std::array<GridPoint, 3>& corners, const ChartCorners& on_chart,
                            const std::array<HugeInt, 3>& normal);
  /// Returns the half-plane with these coefficients.
  static PlaneLine of(HugeInt a, HugeInt b, HugeInt c);
  /// Intersects the wall with a facet that is an image of `charted`, vertex by vertex. The result is a line
  /// of the chart of `charted`. Its coefficients have three bits more.
  static PlaneLine through_image(const FacetCone& image, const FacetCone& charted, const FacetChart& chart,
                                 const std::array<HugeInt, 3>& normal);
  bool is_none() const { return a == 0 && b == 0; }  ///< the two directions were the same
};

/// Returns the side of `line` on which the corner lies where `arriving` turns left into `leaving`: the sign
/// of the determinant.
int side(const PlaneLine& arriving, const PlaneLine& leaving, const PlaneLine& line);

/// A strictly convex polygon: the lines of its edges, counter-clockwise.
using LinePolygon = std::vector<const PlaneLine*>;

/// Returns the polygon of a cyclic list of lines that turn left or continue straight. Lines that continue
/// their neighbour are omitted. The result is empty if it has no area.
LinePolygon line_polygon(const std::vector<PlaneLine>& lines);

/// Removes the part outside of the half-plane. The polygon is empty afterwards if the rest has no area.
/// `sides` is scratch memory.
void clip(LinePolygon& polygon, const PlaneLine& line, std::vector<int>& sides);

/// Returns the intersection of two lines on the chart, relative to the facet's first vertex. Each coordinate
/// is accurate to 4 units in the last place.
glm::dvec2 meeting_point(const PlaneLine& first, const PlaneLine& second);

/// Returns the intersection of two lines relative to the facet's apex, in grid units. Each coordinate is
/// accurate to 4 units in the last place.
glm::dvec3 meeting_point(const FacetCone& facet, const FacetChart& chart, const PlaneLine& first,
                         const PlaneLine& second);

}  // namespace tubefoot
