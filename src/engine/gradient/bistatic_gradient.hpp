// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "engine/gradient/echo_gradient.hpp"
#include "engine/visibility/bistatic_history.hpp"

// Derivatives of the energies of a transmitter and a separate receiver, as those of one apex in
// echo_gradient.hpp. Positions and velocities are relative to the transmit apex. Functions throw
// std::invalid_argument for mirrors, refraction, beam patterns and hits of rays. They also throw it for a
// history without names of edges (VisibilityOptions::corner_names).
namespace tubefoot {

/// Forward mode. Returns the derivatives of all energies, [parameter][beam][sample]. EchoParameter::velocity
/// has rays of both apexes, and receive_apex.
std::vector<std::vector<double>> echo_derivatives(const FacetMesh& mesh, const BistaticHistory& history,
                                                  const ReceiveBeams& beams, const RangeSamples& samples,
                                                  const EchoModel& model,
                                                  std::span<const EchoParameter> parameters);

/// Reverse mode. Returns the gradient of the sum over beams and samples of weight times energy. `weights`:
/// [beam][sample].
EchoGradient echo_gradient(const FacetMesh& mesh, const BistaticHistory& history, const ReceiveBeams& beams,
                           const RangeSamples& samples, const EchoModel& model,
                           std::span<const double> weights,
                           std::span<const MaterialParameter> scattering = {});

}  // namespace tubefoot
