// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>

#include "engine/signal/smooth_surface.hpp"
#include "geometry/integrals/certified_path_cells.hpp"
#include "geometry/integrals/certified_polygon.hpp"
#include "geometry/numbers/ball.hpp"

// What SmoothAmplitude computes by edges, in balls. Heavy: include only in .cpp files.
namespace tubefoot {

/// Pressure [1/m] of what a smooth convex polygon returns of a wave e^{ikr}/r, two ends or one, near or far:
/// the edge form times reflection and roughness at the polygon's place of shortest path, every error
/// enclosed. `points` about the foot point of the apex of the transmit leg, which is `height` above the
/// plane; `tolerance`: of the quadrature, relative to the inverse of the shortest path over the plane. None
/// where that is not reached: for ends in the plane. Law Q11 (certain amplitude): what exact arithmetic has
/// lies in the ball.
std::optional<ComplexBall> certified_amplitude(std::span<const CertifiedPolygon::Point> points,
                                               const Ball& height, const ApexOverPlane& rx,
                                               const SmoothSurface& surface, const Ball& wave_number,
                                               double tolerance);

/// mean_sine() in balls.
Ball certified_mean_sine(std::span<const CertifiedPolygon::Point> points, const Ball& height,
                         const ApexOverPlane& rx);

}  // namespace tubefoot
