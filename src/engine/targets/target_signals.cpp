// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/targets/target_signals.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>

#include "engine/scattering/echo_model.hpp"

namespace tubefoot {
namespace {

/// The path of sound via a target: positions of both ends relative to the target, and times.
struct TargetSoundPath {
  glm::dvec3 from_transmitter_m{0}, from_receiver_m{0};
  double emitted_s = 0, received_s = 0;
};

/// Paths via a target for a channel whose ends may move. A motion is known from the begin of the pulse to the
/// end of the record. Ends count as at rest outside of these times, at which nothing is sent or recorded.
class TargetPaths {
 public:
  TargetPaths(const SignalChannel& channel, glm::dvec3 place_m, const CoherentReceiver& receiver)
      : channel_(channel),
        place_m_(place_m),
        speed_m_s_(receiver.sound_speed_m_s),
        begin_s_(receiver.pulse.begin_s),
        end_s_(std::max(begin_s_, receiver.times.time_s(receiver.times.count))) {}

  glm::dvec3 from_transmitter_m(double at_s) const {
    return place_m_ - (channel_.transmit_motion ? channel_.transmit_motion(std::clamp(at_s, begin_s_, end_s_))
                                                : channel_.transmit_m);
  }
  glm::dvec3 from_receiver_m(double at_s) const {
    return place_m_ - (channel_.receive_motion ? channel_.receive_motion(std::clamp(at_s, begin_s_, end_s_))
                                               : channel_.receive_m);
  }

  TargetSoundPath emitted_at(double emitted_s) const {
    TargetSoundPath path{from_transmitter_m(emitted_s), {}, emitted_s, 0};
    const double arrived_s = emitted_s + glm::length(path.from_transmitter_m) / speed_m_s_;
    path.received_s = solve(arrived_s, [&](double received_s) {
      path.from_receiver_m = from_receiver_m(received_s);
      return arrived_s + glm::length(path.from_receiver_m) / speed_m_s_;
    });
    return path;
  }
  TargetSoundPath received_at(double received_s) const {
    TargetSoundPath path{{}, from_receiver_m(received_s), 0, received_s};
    const double left_s = received_s - glm::length(path.from_receiver_m) / speed_m_s_;
    path.emitted_s = solve(left_s, [&](double emitted_s) {
      path.from_transmitter_m = from_transmitter_m(emitted_s);
      return left_s - glm::length(path.from_transmitter_m) / speed_m_s_;
    });
    return path;
  }

 private:
  /// Each step reduces the error by the ratio of the speed of the end to the sound speed.
  template <class Next>
  static double solve(double start_s, const Next& next) {
    constexpr int most_steps = 60;
    double at_s = next(start_s);
    for (int step = 0; step < most_steps; ++step) {
      const double better_s = next(at_s);
      if (std::abs(better_s - at_s) <= 1e-16 * std::max(1.0, std::abs(better_s))) return better_s;
      at_s = better_s;
    }
    const double last_s = next(at_s);
    if (!(std::abs(last_s - at_s) < 1e-12))
      throw std::invalid_argument("an end of the path to a target in the water is as fast as sound");
    return last_s;
  }

  const SignalChannel& channel_;
  glm::dvec3 place_m_;
  double speed_m_s_, begin_s_, end_s_;
};

}  // namespace

ReachedSamples add_target_signal(const WaterTarget& target, glm::dvec3 place_m, const SignalChannel& channel,
                                 const CoherentReceiver& receiver, double absorption_db_per_m,
                                 std::span<std::complex<double>> samples) {
  const TargetPaths paths(channel, place_m, receiver);
  const BasebandPulse& pulse = receiver.pulse;
  const SignalTimes& times = receiver.times;
  const TargetSoundPath begin = paths.emitted_at(pulse.begin_s), end = paths.emitted_at(pulse.end_s);
  const auto sample_at = [&](double time_s) {
    return std::clamp((time_s - times.first_s) * times.rate_hz, 0.0, static_cast<double>(times.count));
  };
  // One more sample on both sides for rounding; the pulse is 0 there.
  const double from = std::max(std::ceil(sample_at(begin.received_s)) - 1, 0.0),
               to = std::min(std::floor(sample_at(end.received_s)) + 2, static_cast<double>(times.count));
  const ReachedSamples reached{static_cast<std::size_t>(from), static_cast<std::size_t>(std::max(from, to))};
  const double beta_per_m = absorption_per_m(absorption_db_per_m),
               wave_number = 2 * std::numbers::pi * receiver.carrier_hz / receiver.sound_speed_m_s;
  const auto amplitude_of = [&](const TargetSoundPath& path) -> std::complex<double> {
    const double tx_m = glm::length(path.from_transmitter_m), rx_m = glm::length(path.from_receiver_m);
    if (!(tx_m > 0 && rx_m > 0))
      throw std::invalid_argument(
          "a target in the water is at the position of an element of the array: move the target");
    const double strength = std::sqrt(target.cross_section(path.from_transmitter_m, path.from_receiver_m,
                                                           receiver.carrier_hz)),
                 size = strength * amplitude_pattern(channel.transmit, path.from_transmitter_m / tx_m) *
                        amplitude_pattern(channel.receive, path.from_receiver_m / rx_m) *
                        std::exp(-beta_per_m * (tx_m + rx_m) / 2) / (tx_m * rx_m);
    return std::polar(std::abs(size), wave_number * (tx_m + rx_m)) * (size < 0 ? -1.0 : 1.0);
  };
  const std::complex<double> at_rest = channel.has_path() ? 0 : amplitude_of(begin);
  const double delay_s = begin.received_s - begin.emitted_s;
  for (std::size_t k = reached.first; k < reached.end; ++k) {
    if (!channel.has_path()) {
      samples[k] += at_rest * pulse.at(times.time_s(k) - delay_s);
      continue;
    }
    const TargetSoundPath path = paths.received_at(times.time_s(k));
    if (path.emitted_s < pulse.begin_s || path.emitted_s > pulse.end_s) continue;
    samples[k] += amplitude_of(path) * pulse.at(path.emitted_s);
  }
  return reached;
}

}  // namespace tubefoot
