// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "engine/gradient/echo_gradient.hpp"
#include "engine/signal/smooth_signals.hpp"

namespace tubefoot {

/// Converts parameters of energies to those of signals, by the names of the polygons' corners. The ends of
/// channels move as rays do: a rotation of the sonar turns them about the apex. `patches`: visible polygons
/// of `history`. `channels`: ends in the local frame. Throws std::invalid_argument for a history without
/// names of corners.
std::vector<SignalParameter> signal_parameters(const FacetMesh& mesh, const History& history,
                                               const VisiblePolygons& patches,
                                               std::span<const SignalChannel> channels,
                                               std::span<const EchoParameter> parameters);

}  // namespace tubefoot
