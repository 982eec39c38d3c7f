// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/products/received.hpp"

#include <fmt/ranges.h>

#include <cmath>

#include "sensors/products/noise_floor.hpp"
#include "sensors/receiver/pulse.hpp"

namespace tubefoot {

ReceiverChain receiver_of(const Recording& recording, const RunContext& run) {
  const SignalDescription& signal = recording.sensor->description().signal;
  ReceiverDescription receiver;
  receiver.source_level_db = signal.source_level_db;
  receiver.noise_level_db = signal.noise_level_db;
  receiver.speckle.law = signal.speckle == "rayleigh" ? SpeckleLaw::rayleigh
                         : signal.speckle == "k"      ? SpeckleLaw::k
                                                      : SpeckleLaw::none;
  receiver.speckle.looks = signal.speckle_looks;
  receiver.speckle.shape = signal.speckle_shape;
  receiver.tvg = gain_of(recording);
  if (signal.pulse_length_us)
    receiver.source_level_db +=
        10 * std::log10(pulse_extent_m(*signal.pulse_length_us, recording.sound_speed_m_s) /
                        recording.sensor->samples().step_m);
  receiver.seed = run.seed;
  return ReceiverChain(receiver);
}

std::vector<double> received(const Recording& recording, const RunContext& run, std::size_t ping) {
  const RangeSamples& samples = recording.sensor->samples();
  const std::uint32_t number = recording.number_of(ping);
  const ReceiverChain receiver = receiver_of(recording, run);
  const std::optional<double> pulse_us = recording.sensor->description().signal.pulse_length_us;
  const PingEnergies energy = recording.energy_of(ping);
  if (!pulse_us) return receiver.receive(number, energy, samples);
  const double extent_m = pulse_extent_m(*pulse_us, recording.sound_speed_m_s);
  return receiver.receive(number, spread_over_pulse(energy, samples, extent_m), samples);
}

std::optional<Heard> heard_by(const Recording& recording, const RunContext& run) {
  const SignalDescription& signal = recording.sensor->description().signal;
  std::vector<std::string> parts;
  if (signal.speckle != "none") parts.push_back("speckle");
  if (signal.noise_level_db) parts.push_back("noise");
  if (signal.tvg_spreading) parts.push_back("the sonar's own gain");
  if (signal.pulse_length_us) parts.push_back("the pulse's length");
  if (parts.empty()) return std::nullopt;
  return Heard{[&recording, &run](std::size_t ping) { return received(recording, run, ping); },
               signal.tvg_spreading.has_value(), fmt::format("as received, with {}", fmt::join(parts, ", "))};
}

}  // namespace tubefoot
