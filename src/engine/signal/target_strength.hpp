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

// Computes the monostatic target strength of a body in the far field. Source: docs/notes/smooth-surfaces.md.
namespace tubefoot {

/// Backscattering lengths f in m in the Kirchhoff approximation, per wave number in rad/m. The scattered
/// pressure is p_i f e^{ikr} / r, with r and phases relative to the mesh's origin. The cross section is
/// |f|^2 and the target strength 10 log10 |f|^2 in dB re 1 m^2. Each visible part of the surface returns the
/// echo of a plane at its place. Creeping waves, transmitted sound, double reflections and diffraction are
/// not included.
std::vector<std::complex<double>> backscattering_lengths(
    const FarView& view, std::span<const glm::dvec3> points_m,
    std::span<const std::array<std::uint32_t, 3>> triangles, glm::dvec3 towards, const SmoothSurface& surface,
    std::span<const double> wave_numbers_per_m);

/// In dB re 1 m^2; minus infinity for 0.
double target_strength_db(std::complex<double> length_m);

/// Unit vector from a body to the receiver. Azimuth is from x towards y, elevation towards z.
glm::dvec3 sonar_direction(double azimuth_deg, double elevation_deg);

}  // namespace tubefoot
