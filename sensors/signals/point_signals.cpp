// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/signals/point_signals.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

void check_targets(const std::vector<PointScatterer>& targets) {
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const auto& [p, f] = targets[k];
    if (!std::isfinite(p.x + p.y + p.z) || !std::isfinite(f.real() + f.imag()))
      throw std::invalid_argument(fmt::format("scatterer {} is not finite", k));
  }
}

void add_echo(const PointScatterer& target, std::size_t number, const ElementSignals& signals,
              std::size_t ping, std::size_t element, std::span<Complex> channel) {
  const SignalSampling& sampling = signals.sampling;
  const double speed_m_s = signals.sound_speed_m_s, last_s = sampling.end_s();
  const PlaceMotion transmitter(signals.motion, ping, signals.array.transmitter_m, last_s),
      receiver(signals.motion, ping, signals.array.receivers_m[element], last_s);
  const TwoWayPath first = path_emitted_at(0, transmitter, target.position_m, receiver, speed_m_s);
  if (!(first.tx_m > 0 && first.rx_m > 0))
    throw std::invalid_argument(fmt::format(
        "scatterer {} is at the position of an element at ping {}: move the scatterer", number, ping));
  const TwoWayPath last =
      path_emitted_at(signals.waveform.duration_s, transmitter, target.position_m, receiver, speed_m_s);
  const auto sample_at = [&](double time_s) {
    return std::clamp((time_s - sampling.first_s) * sampling.rate_hz, 0.0,
                      static_cast<double>(sampling.samples));
  };
  const auto begin = static_cast<std::size_t>(std::ceil(sample_at(first.received_s)));
  const std::size_t end =
      std::min(sampling.samples, static_cast<std::size_t>(std::floor(sample_at(last.received_s))) + 1);
  const bool still = signals.motion.stop_and_hop();
  for (std::size_t k = begin; k < end; ++k) {
    TwoWayPath path = first;
    if (still)
      path.emitted_s = sampling.time_s(k) - first.delay_s(), path.received_s = sampling.time_s(k);
    else
      path = path_received_at(sampling.time_s(k), transmitter, target.position_m, receiver, speed_m_s);
    const double tau_s = still ? first.delay_s() : path.delay_s();
    const Complex pulse = baseband_at(signals.waveform, sampling.baseband_hz, path.emitted_s);
    const Complex turned =
        std::polar(1 / (path.tx_m * path.rx_m), 2 * std::numbers::pi * sampling.baseband_hz * tau_s);
    channel[k] += target.strength * (pulse * turned);
  }
}

}  // namespace

ElementSignals point_signals(const std::vector<PointScatterer>& targets, const ElementArray& array,
                             const TransmitWaveform& waveform, const SignalSampling& sampling,
                             const VehicleMotion& motion, double sound_speed_m_s) {
  ElementSignals signals = silent_signals(array, waveform, sampling, motion, sound_speed_m_s);
  check_targets(targets);
  // One thread adds all echoes of a channel in the order of the targets. The result is bitwise the same for
  // any number of threads.
  tbb::parallel_for(std::size_t{0}, signals.pings() * signals.receivers(), [&](std::size_t k) {
    stop_if_wanted();
    const std::size_t ping = k / signals.receivers(), element = k % signals.receivers();
    for (std::size_t number = 0; number < targets.size(); ++number)
      add_echo(targets[number], number, signals, ping, element, signals.channel(ping, element));
  });
  return signals;
}

}  // namespace tubefoot
