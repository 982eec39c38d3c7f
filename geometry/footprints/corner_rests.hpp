// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/footprints/plane_lines.hpp"
#include "geometry/numbers/ball_vector.hpp"

// Encloses corners of visible polygons in balls, and computes what rounding to doubles has removed. This
// header is expensive to compile: include it only in .cpp files and in headers of this kind.
namespace tubefoot {

/// Encloses the point of point_on_facet().
BallVector exact_point_on(const NameContext& context, const CornerName& corner, const FacetCone& facet);

/// Encloses the point of meeting_point().
BallVector exact_meeting_point(const FacetCone& facet, const FacetChart& chart, const PlaneLine& first,
                               const PlaneLine& second);

/// Moves a point relative to the apex `from` to the apex `to`.
BallVector moved(BallVector point, GridPoint to, GridPoint from);

/// Returns the exact point, which is given in grid units, minus the rounded point.
glm::dvec3 rest_m(const BallVector& exact, double unit_m, const glm::dvec3& rounded_m);

/// Returns a - b minus its rounded value. The result is exact.
glm::dvec3 rounding_of_difference(const glm::dvec3& a, const glm::dvec3& b);

}  // namespace tubefoot
