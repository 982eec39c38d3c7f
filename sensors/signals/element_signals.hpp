// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "sensors/signals/transmit_waveform.hpp"
#include "sensors/signals/vehicle_motion.hpp"

namespace tubefoot {

/// Positions of a sonar's elements on the vehicle [m, its axes: x starboard, y forward, z up].
struct ElementArray {
  glm::dvec3 transmitter_m{0};
  std::vector<glm::dvec3> receivers_m;

  /// Mean position of the receivers.
  glm::dvec3 centre_m() const;
};

/// A line of uniformly spaced receivers along a direction, with the transmitter in its middle.
ElementArray line_array(std::size_t receivers, glm::dvec3 spacing_m, glm::dvec3 centre_m = glm::dvec3(0));

/// The signals of a sonar's elements for all pings: complex baseband [ping][receiver][sample], in W^1/2. The
/// pulse has the energy 1 J/sr at 1 m. The integral of the squared modulus over time is in J, as the
/// energies of echoes.nc are. Doubles keep a phase to 1e-9 of a wavelength (6e-9 rad), which single
/// precision (6e-8) would lose.
struct ElementSignals {
  TransmitWaveform waveform;
  SignalSampling sampling;
  double sound_speed_m_s = 0;
  ElementArray array;
  VehicleMotion motion;
  bool matched_filtered = false;  ///< the waveform is compressed, so that an echo peaks at its delay
  std::vector<std::complex<double>> pressure;
  /// Certified half-widths of the pressures' real and imaginary parts. They are infinite where no bound
  /// exists. Empty: not certified.
  std::vector<std::complex<double>> bound{};
  /// A derivative of the pressures of smooth surfaces by a parameter of the scene, in the order of the
  /// pressures.
  struct Derivative {
    std::string parameter, units, meaning;
    std::vector<std::complex<double>> values;
  };
  std::vector<Derivative> derivatives{};

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

/// Signals with all data except the pressures, which are 0. Throws std::invalid_argument with advice as
/// check_sampled() does, and for missing or non-finite elements. It also throws for a sound speed that is
/// not positive, without pings, and for a track that ends before the last sample.
ElementSignals silent_signals(const ElementArray& array, const TransmitWaveform& waveform,
                              const SignalSampling& sampling, const VehicleMotion& motion,
                              double sound_speed_m_s);

/// Checks existing signals in the same way, and the number of pressures and bounds.
void check(const ElementSignals& signals);

}  // namespace tubefoot
