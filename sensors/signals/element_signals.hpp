// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sensors/signals/transmit_waveform.hpp"
#include "sensors/signals/vehicle_motion.hpp"

namespace tubefoot {

/// Where a sonar's elements sit on the vehicle [m, its axes: x starboard, y forward, z up].
struct ElementArray {
  glm::dvec3 transmitter_m{0};
  std::vector<glm::dvec3> receivers_m;

  /// Mean place of the receivers.
  glm::dvec3 centre_m() const;
};

/// A line of receivers about a place, evenly spaced along a direction, with the transmitter in its middle.
ElementArray line_array(std::size_t receivers, glm::dvec3 spacing_m, glm::dvec3 centre_m = glm::dvec3(0));

/// What the elements of a sonar receive of all pings: complex baseband [ping][receiver][sample], in W^1/2,
/// for a pulse of energy 1 J/sr at 1 m, so that the integral of its squared modulus over time is in J as the
/// energies of echoes.nc are. Doubles: a phase is kept to 1e-9 of a wavelength (6e-9 rad), which single
/// precision (6e-8) would lose.
struct ElementSignals {
  TransmitWaveform waveform;
  SignalSampling sampling;
  double sound_speed_m_s = 0;
  ElementArray array;
  VehicleMotion motion;
  bool matched_filtered = false;  ///< the waveform is compressed: an echo peaks at its delay
  std::vector<std::complex<double>> pressure;
  /// Certified half-widths of the pressures' real and imaginary parts, infinite where there is no bound;
  /// none: not certified.
  std::vector<std::complex<double>> bound{};

  std::size_t pings() const { return motion.pings(); }
  std::size_t receivers() const { return array.receivers_m.size(); }
  std::size_t samples() const { return sampling.samples; }
  std::span<const std::complex<double>> channel(std::size_t ping, std::size_t receiver) const {
    return std::span(pressure).subspan((ping * receivers() + receiver) * samples(), samples());
  }
  std::span<std::complex<double>> channel(std::size_t ping, std::size_t receiver) {
    return std::span(pressure).subspan((ping * receivers() + receiver) * samples(), samples());
  }
};

/// All of it but the pressures, which are 0. Throws std::invalid_argument, saying what to do, for what makes
/// no signals: check_sampled(), elements that are not finite or missing, a sound speed that is not above 0,
/// no pings, a track that ends before the last sample.
ElementSignals silent_signals(const ElementArray& array, const TransmitWaveform& waveform,
                              const SignalSampling& sampling, const VehicleMotion& motion,
                              double sound_speed_m_s);

/// The same for signals that somebody else made; also for too many or too few pressures or bounds.
void check(const ElementSignals& signals);

}  // namespace tubefoot
