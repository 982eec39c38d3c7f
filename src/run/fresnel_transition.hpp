// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "run/transmission.hpp"

namespace tubefoot {

/// Returns the distance from a shadow border, perpendicular to the ray, at which the Fresnel parameter of the
/// edge of a half-plane is 1:
///     nu = h sqrt(2 d1 / (lambda d2 (d1 + d2))),
/// with the distance d1 from the sonar to the edge and d2 from the edge to the point. The two-way intensity
/// at this distance in the shadow is 27.73 dB below that without the half-plane. Lengths in metres.
double fresnel_width_m(double to_edge_m, double beyond_edge_m, double wavelength_m);

/// Width of the transition from insonified to shadow on the surfaces that a sensor sees. Geometric shadows
/// have no transition.
struct FresnelTransition {
  std::size_t pings = 0;  ///< number of pings that were examined
  double length_m = 0;    ///< length of all shadow borders
  std::array<double, 3>
      width_m{};  /// fresnel_width_m() on the surface: percentiles 5, 50 and 95 of the length
};

/// Examines the first, the middle and the last ping of a sensor, for the transmitter and surfaces at apparent
/// positions. Empty if they have no shadow borders. Throws the errors of Transmission::surface_mesh().
std::optional<FresnelTransition> fresnel_transition(const Transmissions& transmissions, std::size_t sensor);

/// Returns the transition as a text, for example "0.11 m wide (0.05 to 0.3 m) on 12 m of borders".
std::string text_of(const FresnelTransition& transition);

}  // namespace tubefoot
