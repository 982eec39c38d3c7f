// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <glm/vec3.hpp>
#include <span>

#include "engine/signal/coherent_signals.hpp"
#include "engine/targets/water_target.hpp"

namespace tubefoot {

/// Samples [first, end) that a signal reaches.
struct ReachedSamples {
  std::size_t first = 0, end = 0;
};

/// Adds the echo of a target at a place in the local frame to the samples of one channel, relative to the
/// carrier:
///     sqrt(sigma) A_tx A_rx e^(-beta L / 2) / (r_tx r_rx) e^{ikL} g(t - L / c).
/// L = r_tx + r_rx is the length of the path and g the pulse. A are the amplitude patterns. Delays and phases
/// are exact to the rounding of doubles; the pulse is not tabulated. With moving ends, each sample has the
/// path of the sound that arrives at its time. Returns the samples that the echo reaches. Throws
/// std::invalid_argument for a target at the position of an element, and for an end as fast as sound.
ReachedSamples add_target_signal(const WaterTarget& target, glm::dvec3 place_m, const SignalChannel& channel,
                                 const CoherentReceiver& receiver, double absorption_db_per_m,
                                 std::span<std::complex<double>> samples);

}  // namespace tubefoot
