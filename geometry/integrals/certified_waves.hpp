// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The functions of polygon_transform.hpp and edge_form.hpp in ball arithmetic, with all errors enclosed.
// This header is expensive to compile; include it only in .cpp files and in headers of integrators.

#include <array>
#include <optional>
#include <span>

#include "geometry/integrals/certified_path_cells.hpp"
#include "geometry/integrals/certified_polygon.hpp"
#include "geometry/numbers/ball.hpp"

namespace tubefoot {

/// e^{i phase}.
ComplexBall certified_phasor(const Ball& phase);

/// The mean of e^{i phase} over a triangle with these phases at its corners. The enclosure is narrow for all
/// phases. If two phases certainly differ by 2 or more, the function uses the divided difference, otherwise
/// the series.
ComplexBall certified_mean_phasor(const std::array<Ball, 3>& phases);

/// Integral of e^{i (x gradient_x + y gradient_y)} over a polygon, as a fan of triangles.
ComplexBall certified_transform(std::span<const CertifiedPolygon::Point> points, const Ball& gradient_x,
                                const Ball& gradient_y);

/// The integral of EdgeForm for F(P) = e^{ikP} over a polygon. `points` are relative to the foot point of
/// the transmitter, which is `height` above the plane. `tolerance` bounds the quadrature error relative to 1
/// / D; the radius beyond it comes from the corners. Returns nothing if the tolerance is not reached or an
/// apex lies in the plane.
std::optional<ComplexBall> certified_edge_form(std::span<const CertifiedPolygon::Point> points,
                                               const Ball& height, const ApexOverPlane& rx, const Ball& k,
                                               double tolerance);

}  // namespace tubefoot
