// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "engine/gradient/echo_gradient.hpp"
#include "engine/paths/path_echo.hpp"

namespace tubefoot {

/// Returns the derivatives of the energies of path_echo() in isovelocity water, summed over the orders for
/// which `is_wanted` holds: [parameter][beam][sample]. They hold for fixed combinatorics (echo_gradient.hpp).
/// Mirror facets in one plane must stay in one plane. The sea surface is horizontal and at rest in the local
/// frame (EchoParameter::apex_velocity). Throws std::invalid_argument for beam patterns, several scatterings,
/// rays and references, and the exceptions of path_echo().
std::vector<std::vector<double>> path_derivatives(const FacetMesh& mesh, const SceneTree& tree,
                                                  double grid_unit_m, const VisibilityOptions& options,
                                                  const TubeSet& transmit, const TubeSet& receive,
                                                  const ReceiveBeams& beams, const RangeSamples& samples,
                                                  const EchoModel& model, const PathSettings& settings,
                                                  std::span<const EchoParameter> parameters,
                                                  const std::function<bool(std::size_t order)>& is_wanted);

/// Reverse mode. Returns the gradient of the sum over beams and samples of weight times energy. `weights`:
/// [beam][sample]. Rays are those of `transmit` and of `receive`. EchoGradient::by_apex is the derivative by
/// EchoParameter::apex_velocity.
EchoGradient path_gradient(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                           const VisibilityOptions& options, const TubeSet& transmit, const TubeSet& receive,
                           const ReceiveBeams& beams, const RangeSamples& samples, const EchoModel& model,
                           const PathSettings& settings, std::span<const double> weights,
                           std::span<const MaterialParameter> scattering,
                           const std::function<bool(std::size_t order)>& is_wanted);

}  // namespace tubefoot
