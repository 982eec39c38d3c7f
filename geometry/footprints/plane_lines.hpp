// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/arithmetic/wide_vector.hpp"
#include "geometry/mesh/facet_cone.hpp"

// Convex polygons on a facet as cyclic lists of lines with integer coefficients: a corner is two neighbouring
// lines left unevaluated, and the only decision is the sign of a determinant of three lines.
namespace tubefoot {

/// Bits: a corner's direction has at most 314 (two depth planes of 156), a wall through two of them 630
/// (nearly always it is one of their planes, and has 61 or 156), a line's coefficients 693 and, times the
/// facet's vertex, 727; a determinant of three lines 2117. A corner's numerators have at most 1488. Lines of
/// an image add at most 3 bits each; on a chart of weights (coverage.hpp), of 45 bits, they have 710 and 755,
/// a determinant 2180.
using HugeInt = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<
    2304, 2304, boost::multiprecision::signed_magnitude, boost::multiprecision::unchecked, void>>;

/// Coordinates on a facet's plane: two of the three axes, u and v relative to the facet's first vertex,
/// chosen so that what turns about the facet's normal (FacetCone) turns counter-clockwise. Apexes on the same
/// side of a facet have the same chart.
struct FacetChart {
  int u = 0, v = 1, w = 2;
  explicit FacetChart(const FacetCone& facet);
};

/// Where the corners of a facet lie on a chart, counter-clockwise.
using ChartCorners = std::array<std::array<std::int64_t, 2>, 3>;

/// The inward normal of the wall from one direction to the next.
std::array<HugeInt, 3> wall_normal(const WideVec& from, const WideVec& to);

/// A half-plane a u + b v + c >= 0 of a facet.
struct PlaneLine {
  HugeInt a, b, c;
  /// The same times a power of two that brings the larger of |a|, |b| to [1, 2): each within 2^-52 of itself.
  double a_near = 0, b_near = 0, c_near = 0;

  /// On the inner side of the plane through the apex of `facet` with that inward normal, of 630 bits at most.
  static PlaneLine on_plane(const FacetCone& facet, const FacetChart& chart,
                            const std::array<HugeInt, 3>& normal);
  /// Where the plane through an apex with that inward normal (630 bits at most) cuts a facet with these
  /// corners relative to the apex, as a line of a chart on which they lie elsewhere: an image, or a part of
  /// another facet. Of chart coordinates of n bits a and b have 2 + n more than the corners' distances from
  /// the plane, c has 1 + 2 n more.
  static PlaneLine on_image(const std::array<GridPoint, 3>& corners, const ChartCorners& on_chart,
                            const std::array<HugeInt, 3>& normal);
  /// Of these coefficients.
  static PlaneLine of(HugeInt a, HugeInt b, HugeInt c);
  /// The same of a facet that is an image of `charted`, vertex by vertex: where the wall cuts the image, as a
  /// line of the chart of `charted`. Three bits more.
  static PlaneLine through_image(const FacetCone& image, const FacetCone& charted, const FacetChart& chart,
                                 const std::array<HugeInt, 3>& normal);
  bool is_none() const { return a == 0 && b == 0; }  ///< the two directions were the same
};

/// Where corner x, in which `arriving` turns left into `leaving`, lies of the line: sign of the determinant.
int side(const PlaneLine& arriving, const PlaneLine& leaving, const PlaneLine& line);

/// A strictly convex polygon: its edges' lines, counter-clockwise.
using LinePolygon = std::vector<const PlaneLine*>;

/// Polygon of a cyclic list of lines that turn left or run on straight: lines that continue their neighbour
/// are left out. Empty if what remains has no area.
LinePolygon line_polygon(const std::vector<PlaneLine>& lines);

/// Takes away what is outside of the half-plane. Empty if what remains has no area. `sides` is scratch
/// memory.
void clip(LinePolygon& polygon, const PlaneLine& line, std::vector<int>& sides);

/// The point of two lines on the chart, relative to the facet's first vertex; each coordinate to 4 units in
/// the last place.
glm::dvec2 meeting_point(const PlaneLine& first, const PlaneLine& second);

/// The point of two lines relative to the facet's apex, in grid units; each coordinate to 4 units in the last
/// place.
glm::dvec3 meeting_point(const FacetCone& facet, const FacetChart& chart, const PlaneLine& first,
                         const PlaneLine& second);

}  // namespace tubefoot
