// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/signal/smooth_surface.hpp"
#include "engine/visibility/far_view.hpp"

// What a body returns to where sound came from, both far away. docs/smooth-surfaces.md
namespace tubefoot {

/// Backscattering lengths f [m] in the Kirchhoff approximation, one for each wave number [rad/m]: the
/// scattered pressure is p_i f e^{ikr} / r with r and phases from the mesh's origin, the cross-section |f|^2
/// and the target strength 10 log10 |f|^2, dB re 1 m^2. Every part of the surface that is seen, and nothing
/// else, returns what a plane there would; sound that goes round the body or through it, is reflected twice
/// or diffracted is not in it.
std::vector<std::complex<double>> backscattering_lengths(
    const FarView& view, std::span<const glm::dvec3> points_m,
    std::span<const std::array<std::uint32_t, 3>> triangles, glm::dvec3 towards, const SmoothSurface& surface,
    std::span<const double> wave_numbers_per_m);

/// dB re 1 m^2; minus infinity for 0.
double target_strength_db(std::complex<double> length_m);

/// Unit vector from a body to where it is received: azimuth from x towards y, elevation towards z.
glm::dvec3 sonar_direction(double azimuth_deg, double elevation_deg);

}  // namespace tubefoot
