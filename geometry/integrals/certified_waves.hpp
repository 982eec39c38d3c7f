// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>

#include "geometry/integrals/certified_path_cells.hpp"
#include "geometry/integrals/certified_polygon.hpp"
#include "geometry/numbers/ball.hpp"

// What polygon_transform.hpp and edge_form.hpp compute, in balls: enclosures, with every error of theirs in
// them. Heavy: include only in .cpp files and headers of integrators.
namespace tubefoot {

/// e^{i phase}.
ComplexBall certified_phasor(const Ball& phase);

/// The mean of e^{i phase} over a triangle at whose corners the phase is so much. Not wide for any phases:
/// the quotient of differences where two of them surely differ by 2 or more, the series elsewhere.
ComplexBall certified_mean_phasor(const std::array<Ball, 3>& phases);

/// Integral of e^{i (x gradient_x + y gradient_y)} over a polygon, as a fan of triangles.
ComplexBall certified_transform(std::span<const CertifiedPolygon::Point> points, const Ball& gradient_x,
                                const Ball& gradient_y);

/// EdgeForm's integral of F(P) = e^{ikP} over a polygon: `points` about the foot point of the apex of the way
/// out, which is `height` above the plane. `tolerance`: of the quadrature's error, relative to 1 / D; what
/// the radius has beyond it comes from the corners. None where that is not reached: for ends in the plane.
std::optional<ComplexBall> certified_edge_form(std::span<const CertifiedPolygon::Point> points,
                                               const Ball& height, const ApexOverPlane& rx, const Ball& k,
                                               double tolerance);

}  // namespace tubefoot
