// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <glm/vec3.hpp>
#include <vector>

#include "engine/scattering/range_samples.hpp"
#include "sensors/beamforming/signal_interpolator.hpp"
#include "sensors/signals/element_signals.hpp"

namespace tubefoot {

/// Receive beams of an array: the signal that a transducer would have which transmits and receives at one
/// reference place and receives one direction. Its sample at the time t is of what is c t / 2 away.
struct BeamSteering {
  std::vector<glm::dvec3> directions{};  ///< on the vehicle's axes; of any length above 0
  std::vector<double> weights{};         ///< of the receivers, their sum not 0; empty: all 1
  /// On the vehicle; the beams' time and phase are counted from there.
  glm::dvec3 reference_m{0};
  /// Every sample is focused at its own distance, by the exact two-way delays of that place at rest, of
  /// vehicles on the way as well. Off: plane waves, and a vehicle that stands still.
  bool near_field = false;
};

/// Directions across the vehicle: `angles_rad` from down, to starboard.
std::vector<glm::dvec3> across_track_fan(const std::vector<double>& angles_rad);
/// Directions in the plane of forward and starboard, tilted down by `depression_rad`: `angles_rad` from
/// forward, to starboard.
std::vector<glm::dvec3> forward_fan(const std::vector<double>& angles_rad, double depression_rad);

/// y(t) = sum over the receivers e of w_e s_e(t + d_e) e^{-i omega_b d_e} / sum of w_e, [beam][sample], with
/// the delay t + d_e of what is c t / 2 away in the beam's direction. Throws std::invalid_argument for what
/// makes no beams.
std::vector<std::complex<double>> delay_and_sum(const ElementSignals& signals, std::size_t ping,
                                                const BeamSteering& steering,
                                                const SignalInterpolator& interpolator);

/// The same of plane waves by phases, e^{-2 pi i f d_e} at every frequency f of the spectrum: exact between
/// the samples for what is of the band and as long as the record, without taps. Not for near fields.
std::vector<std::complex<double>> phase_and_sum(const ElementSignals& signals, std::size_t ping,
                                                const BeamSteering& steering);

/// Energies [J], [beam][sample]: of each range sample the sum of |y|^2 over the times 2 r / c that are in it,
/// each for 1 / sampling rate. What pictures, detection and files of energies take. Of signals that
/// are matched filtered they are in proportion to energies, and in no unit: a filter keeps peaks, not sums.
std::vector<double> beam_energies(const std::vector<std::complex<double>>& beams,
                                  const SignalSampling& sampling, double sound_speed_m_s,
                                  const RangeSamples& samples);

}  // namespace tubefoot
