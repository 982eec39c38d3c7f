// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <glm/vec3.hpp>
#include <vector>

#include "engine/scattering/range_samples.hpp"
#include "sensors/beamforming/signal_interpolator.hpp"
#include "sensors/signals/element_signals.hpp"

namespace tubefoot {

/// Receive beams of an array. A beam is the signal of a transducer at one reference position that transmits
/// and receives there, and receives one direction. Its sample at the time t belongs to the distance c t / 2.
struct BeamSteering {
  std::vector<glm::dvec3> directions{};  ///< on the vehicle's axes; of any length above 0
  std::vector<double> weights{};         ///< of the receivers, with a sum other than 0; empty: all 1
  /// Position on the vehicle. The time and phase of the beams refer to it.
  glm::dvec3 reference_m{0};
  /// Focuses every sample at its own distance, by the exact two-way delays of that position at rest, also
  /// for moving vehicles. Without this flag waves are plane and the vehicle stands still.
  bool near_field = false;
};

/// Directions across the vehicle. `angles_rad` counts from down, positive to starboard.
std::vector<glm::dvec3> across_track_fan(const std::vector<double>& angles_rad);
/// Directions in the plane of forward and starboard, tilted down by `depression_rad`. `angles_rad` counts
/// from forward, positive to starboard.
std::vector<glm::dvec3> forward_fan(const std::vector<double>& angles_rad, double depression_rad);

/// y(t) = sum over the receivers e of w_e s_e(t + d_e) e^{-i omega_b d_e} / sum of w_e, [beam][sample]. The
/// delay t + d_e is that of a point at distance c t / 2 in the beam's direction. Throws
/// std::invalid_argument for invalid arguments.
std::vector<std::complex<double>> delay_and_sum(const ElementSignals& signals, std::size_t ping,
                                                const BeamSteering& steering,
                                                const SignalInterpolator& interpolator);

/// The same for plane waves, by phases e^{-2 pi i f d_e} at every frequency f of the spectrum. For
/// band-limited signals within the record the result is exact between the samples, without taps. It does not
/// support near fields.
std::vector<std::complex<double>> phase_and_sum(const ElementSignals& signals, std::size_t ping,
                                                const BeamSteering& steering);

/// Energies [J/m^2], [beam][sample]. Each range sample has the sum of |y|^2 over the times 2 r / c within it,
/// times 1 / sampling rate. Images, detection and files of energies use these values. For matched-filtered
/// signals they are proportional to energies, without a unit, because a matched filter preserves peaks, not
/// sums.
std::vector<double> beam_energies(const std::vector<std::complex<double>>& beams,
                                  const SignalSampling& sampling, double sound_speed_m_s,
                                  const RangeSamples& samples);

}  // namespace tubefoot
