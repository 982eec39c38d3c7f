// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/products/received.hpp"

#include <fmt/ranges.h>

#include <cmath>

#include "sensors/products/noise_floor.hpp"
#include "sensors/receiver/lit_samples.hpp"
#include "sensors/receiver/pulse.hpp"

namespace tubefoot {

ReceiverChain receiver_of(const Recording& recording, const RunContext& run) {
  const SignalDescription& signal = recording.sensor->description().signal;
  ReceiverDescription receiver;
  receiver.source_level_db = signal.source_level_db;
  receiver.noise_level_db = signal.noise_level_db;
  receiver.speckle.model = signal.speckle == "rayleigh" ? SpeckleModel::rayleigh
                           : signal.speckle == "k"      ? SpeckleModel::k
                                                        : SpeckleModel::none;
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

ReceivedPings::ReceivedPings(const Recording& recording, const RunContext& run)
    : ReceivedPings(recording, receiver_of(recording, run),
                    recording.sensor->description().signal.pulse_length_us) {}

ReceivedPings::ReceivedPings(const Recording& recording, const ReceiverChain& chain,
                             std::optional<double> pulse_us)
    : recording_(&recording), chain_(chain), gains_(chain.gains(recording.sensor->samples())) {
  if (pulse_us) extent_m_ = pulse_extent_m(*pulse_us, recording.sound_speed_m_s);
}

std::vector<double> ReceivedPings::of(std::size_t ping) const {
  const std::uint32_t number = recording_->number_of(ping);
  const PingEnergies energies = recording_->energy_of(ping);
  if (!extent_m_) return chain_.receive(number, energies, gains_);
  return chain_.receive(number, spread_over_pulse(energies, recording_->sensor->samples(), *extent_m_),
                        gains_);
}

std::vector<double> ReceivedPings::of_beam(std::size_t ping, std::size_t beam,
                                           std::span<const double> energies) const {
  std::span<const double> receiver_output = energies.subspan(beam * gains_.size(), gains_.size());
  std::vector<double> spread;
  if (extent_m_)
    receiver_output = spread = spread_over_pulse(receiver_output, recording_->sensor->samples(), *extent_m_);
  if (chain_.noise_j() == 0) receiver_output = receiver_output.first(lit_samples(receiver_output).end);
  std::vector<double> received(receiver_output.size());
  chain_.receive_beam(recording_->number_of(ping), static_cast<std::uint32_t>(beam), receiver_output, gains_,
                      received);
  received.resize(lit_samples(received).end);
  return received;
}

std::optional<ReceiverOutput> receiver_output_of(const Recording& recording, const RunContext& run) {
  const SignalDescription& signal = recording.sensor->description().signal;
  std::vector<std::string> parts;
  if (signal.speckle != "none") parts.push_back("speckle");
  if (signal.noise_level_db) parts.push_back("noise");
  if (signal.tvg_spreading) parts.push_back("the gain of the sonar");
  if (signal.pulse_length_us) parts.push_back("the length of the pulse");
  if (parts.empty()) return std::nullopt;
  return ReceiverOutput{[pings = ReceivedPings(recording, run)](std::size_t ping) { return pings.of(ping); },
                        signal.tvg_spreading.has_value(),
                        fmt::format("as received, with {}", fmt::join(parts, ", "))};
}

}  // namespace tubefoot
