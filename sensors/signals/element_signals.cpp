// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/signals/element_signals.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "sensors/signals/require.hpp"

namespace tubefoot {
namespace {

bool finite(glm::dvec3 place) {
  return std::isfinite(place.x) && std::isfinite(place.y) && std::isfinite(place.z);
}

/// Number of pressures of the signals.
std::size_t pressures_of(const ElementSignals& signals) {
  constexpr double most = 0x1p31;  // 32 GB
  const double all = static_cast<double>(signals.pings()) * static_cast<double>(signals.receivers()) *
                     static_cast<double>(signals.samples());
  require(all <= most, fmt::format("{} pings x {} receivers x {} samples are {:.3g} pressures, but the limit "
                                   "is 2^31: use fewer pings at a time",
                                   signals.pings(), signals.receivers(), signals.samples(), all));
  return signals.pings() * signals.receivers() * signals.samples();
}

void check_all_but_pressure(const ElementSignals& signals) {
  check_sampled(signals.waveform, signals.sampling);
  require(signals.sound_speed_m_s > 0 && std::isfinite(signals.sound_speed_m_s),
          fmt::format("the sound speed is {} m/s, but must be above 0 and finite", signals.sound_speed_m_s));
  require(signals.receivers() > 0, "the array has no receivers: give at least one receiver");
  require(finite(signals.array.transmitter_m), "the position of the transmitter is not finite");
  for (std::size_t k = 0; k < signals.receivers(); ++k)
    require(finite(signals.array.receivers_m[k]),
            fmt::format("the position of receiver {} is not finite", k));
  require(signals.pings() > 0, "there are no pings: give the start of at least one ping");
  signals.motion.check_lasts(signals.sampling.end_s());
}

}  // namespace

glm::dvec3 ElementArray::centre_m() const {
  glm::dvec3 sum(0);
  for (const glm::dvec3& place : receivers_m) sum += place;
  return sum / static_cast<double>(receivers_m.size());
}

ElementArray line_array(std::size_t receivers, glm::dvec3 spacing_m, glm::dvec3 centre_m) {
  ElementArray array{centre_m, {}};
  for (std::size_t k = 0; k < receivers; ++k)
    array.receivers_m.push_back(
        centre_m + spacing_m * (static_cast<double>(k) - 0.5 * static_cast<double>(receivers - 1)));
  return array;
}

ElementSignals silent_signals(const ElementArray& array, const TransmitWaveform& waveform,
                              const SignalSampling& sampling, const VehicleMotion& motion,
                              double sound_speed_m_s) {
  ElementSignals signals{waveform, sampling, sound_speed_m_s, array, motion, false, {}};
  check_all_but_pressure(signals);
  signals.pressure.resize(pressures_of(signals));
  return signals;
}

void check(const ElementSignals& signals) {
  check_all_but_pressure(signals);
  const std::size_t expected = pressures_of(signals);
  require(signals.pressure.size() == expected,
          fmt::format("there are {} pressures, but {} pings x {} receivers x {} samples = {}",
                      signals.pressure.size(), signals.pings(), signals.receivers(), signals.samples(),
                      expected));
  require(signals.bound.empty() || signals.bound.size() == expected,
          fmt::format("there are {} bounds for {} pressures: give one bound per pressure, or no bounds",
                      signals.bound.size(), expected));
}

}  // namespace tubefoot
