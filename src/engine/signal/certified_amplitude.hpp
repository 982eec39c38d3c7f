// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>

#include "engine/signal/smooth_surface.hpp"
#include "geometry/integrals/certified_path_cells.hpp"
#include "geometry/integrals/certified_polygon.hpp"
#include "geometry/numbers/ball.hpp"

// Encloses the edge form of SmoothAmplitude in ball arithmetic. Heavy: include only in .cpp files.
namespace tubefoot {

/// Pressure in 1/m that a smooth convex polygon returns of a wave e^{ikr}/r, monostatic or bistatic, in the
/// near or far field. The result is the edge form times reflection and roughness at the polygon's place of
/// shortest path. It encloses all errors. `points`: corners relative to the foot point of the apex of the
/// transmit leg, which is `height` above the plane. `tolerance`: error of the quadrature, relative to the
/// inverse of the shortest path over the plane. Returns none if the quadrature does not reach the tolerance
/// or if an end lies in the plane.
/// Law Q11 (certain amplitude): the exact value lies in the ball.
std::optional<ComplexBall> certified_amplitude(std::span<const CertifiedPolygon::Point> points,
                                               const Ball& height, const ApexOverPlane& rx,
                                               const SmoothSurface& surface, const Ball& wave_number,
                                               double tolerance);

/// mean_sine() in ball arithmetic.
Ball certified_mean_sine(std::span<const CertifiedPolygon::Point> points, const Ball& height,
                         const ApexOverPlane& rx);

}  // namespace tubefoot
