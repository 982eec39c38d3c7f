// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/products/received.hpp"

#include <fmt/ranges.h>

#include <bit>
#include <cmath>
#include <iterator>

#include "sensors/products/noise_floor.hpp"
#include "sensors/receiver/lit_samples.hpp"
#include "sensors/receiver/pulse.hpp"

namespace tubefoot {

ReceiverChain receiver_of(const Recording& recording, const RunContext& run, std::size_t sector) {
  const SignalDescription& signal = recording.sensor->description().signal;
  ReceiverDescription receiver;
  receiver.source_level_db = signal.source_level_db;
  receiver.noise_level_db = signal.noise_level_db;
  receiver.speckle.model = signal.speckle == "rayleigh" ? SpeckleModel::rayleigh
                           : signal.speckle == "k"      ? SpeckleModel::k
                                                        : SpeckleModel::none;
  receiver.speckle.looks = signal.speckle_looks;
  receiver.speckle.shape = signal.speckle_shape;
  receiver.tvg = gain_of(recording, sector);
  if (signal.quantisation_bits)
    receiver.quantiser.emplace(signal.quantisation_bottom_db, signal.quantisation_top_db,
                               *signal.quantisation_bits);
  if (const auto pulse_us = recording.sensor->pulse_length_us(sector))
    receiver.source_level_db += 10 * std::log10(pulse_extent_m(*pulse_us, recording.sound_speed_m_s) /
                                                recording.sensor->samples().step_m);
  receiver.seed = run.seed;
  return ReceiverChain(receiver);
}

std::vector<ReceivedPings::Sector> ReceivedPings::sectors_of(const Recording& recording,
                                                             const RunContext& run) {
  std::vector<Sector> sectors;
  for (std::size_t k = 0; k < recording.sectors(); ++k) {
    sectors.push_back({receiver_of(recording, run, k), {}, {}});
    if (const auto pulse_us = recording.sensor->pulse_length_us(k))
      sectors.back().extent_m = pulse_extent_m(*pulse_us, recording.sound_speed_m_s);
  }
  return sectors;
}

ReceivedPings::ReceivedPings(const Recording& recording, const RunContext& run)
    : ReceivedPings(sectors_of(recording, run), recording) {}

ReceivedPings::ReceivedPings(std::vector<Sector> sectors, const Recording& recording)
    : recording_(&recording), sectors_(std::move(sectors)) {
  for (Sector& sector : sectors_) sector.gains = sector.chain.gains(recording.sensor->samples());
}

std::uint32_t ReceivedPings::beam_number(std::size_t beam) const {
  return recording_->beam_numbers.empty() ? static_cast<std::uint32_t>(beam) : recording_->beam_numbers[beam];
}

std::vector<double> ReceivedPings::spread(std::span<const double> values) const {
  const RangeSamples& samples = recording_->sensor->samples();
  if (sectors_.size() == 1) {
    if (sectors_.front().extent_m) return spread_over_pulse(values, samples, *sectors_.front().extent_m);
    return {values.begin(), values.end()};
  }
  std::vector<double> all;
  all.reserve(values.size());
  for (std::size_t beam = 0; all.size() < values.size(); ++beam) {
    const std::vector<double> own = spread_beam(beam, values.subspan(all.size(), this->samples()));
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

std::vector<double> ReceivedPings::spread_beam(std::size_t beam, std::span<const double> values) const {
  const std::optional<double>& extent_m = sector_of(beam).extent_m;
  if (extent_m) return spread_over_pulse(values, recording_->sensor->samples(), *extent_m);
  return {values.begin(), values.end()};
}

std::vector<double> ReceivedPings::of(std::size_t ping) const {
  const PingEnergies kept = recording_->energy_of(ping);
  const std::vector<double> energies = spread(kept);
  std::vector<double> received(energies.size());
  const std::size_t count = samples();
  for (std::size_t beam = 0; beam * count < energies.size(); ++beam)
    sector_of(beam).chain.receive_beam(
        recording_->number_of(ping), beam_number(beam), std::span(energies).subspan(beam * count, count),
        sector_of(beam).gains, std::span(received).subspan(beam * count, count));
  return received;
}

std::vector<double> ReceivedPings::lower_of(std::size_t ping) const {
  std::vector<double> channels[4], received;
  for (std::size_t channel = 0; channel < std::size(channels); ++channel) {
    const PingEnergies kept = recording_->channel_of(ping, channel);
    channels[channel] = spread(kept);
  }
  auto& [upper, lower, product, imaginary] = channels;
  for (std::size_t k = 0; k < product.size(); ++k) product[k] = std::hypot(product[k], imaginary[k]);
  received.resize(lower.size());
  const std::size_t count = samples();
  for (std::size_t beam = 0; beam * count < lower.size(); ++beam) {
    const auto own = [&](auto& all) { return std::span(all).subspan(beam * count, count); };
    sector_of(beam).chain.receive_lower_beam(recording_->number_of(ping), beam_number(beam), own(upper),
                                             own(lower), own(product), sector_of(beam).gains, own(received));
  }
  return received;
}

std::vector<double> ReceivedPings::of_beam(std::size_t ping, std::size_t beam,
                                           std::span<const double> energies) const {
  const Sector& sector = sector_of(beam);
  std::span<const double> receiver_output = energies.subspan(beam * samples(), samples());
  std::vector<double> pulse;
  if (sector.extent_m) receiver_output = pulse = spread_beam(beam, receiver_output);
  if (sector.chain.noise_j() == 0) receiver_output = receiver_output.first(lit_samples(receiver_output).end);
  std::vector<double> received(receiver_output.size());
  sector.chain.receive_beam(recording_->number_of(ping), beam_number(beam), receiver_output, sector.gains,
                            received);
  received.resize(lit_samples(received).end);
  return received;
}

std::optional<ReceiverOutput> receiver_output_of(const Recording& recording, const RunContext& run) {
  const SignalDescription& signal = recording.sensor->description().signal;
  if (recording.sensor->signals() != nullptr) return std::nullopt;  // its received data are its signals
  std::vector<std::string> parts;
  if (signal.speckle != "none") parts.push_back("speckle");
  if (signal.noise_level_db) parts.push_back("noise");
  if (signal.tvg_spreading) parts.push_back("the gain of the sonar");
  bool has_pulse = false;
  for (std::size_t k = 0; k < recording.sectors(); ++k)
    has_pulse = has_pulse || recording.sensor->pulse_length_us(k).has_value();
  if (has_pulse) parts.push_back("the length of the pulse");
  if (signal.quantisation_bits) parts.push_back("quantisation");
  if (parts.empty()) return std::nullopt;
  const ReceivedPings pings(recording, run);
  ReceiverOutput output{
      [pings](std::size_t ping) { return pings.of(ping); }, signal.tvg_spreading.has_value(),
      fmt::format("as received, with {}", fmt::join(parts, ", ")), run.seed, pings.chain().level_db(1)};
  for (std::size_t k = 0; k < recording.sensor->transmit_sectors().size(); ++k)
    output.sector_unit_level_db.push_back(receiver_of(recording, run, k).level_db(1));
  if (recording.channels() > 1)
    output.lower_energy_of = [pings](std::size_t ping) { return pings.lower_of(ping); };
  if (signal.quantisation_bits)
    output.codes = {*signal.quantisation_bits, signal.quantisation_bottom_db,
                    pings.chain().quantiser()->step()};
  return output;
}

std::vector<double> ReceiverOutput::recorded_energy_of(std::size_t ping, bool lower) const {
  constexpr int dropped_bits = 29;  // of the 53 bits of a double
  constexpr std::uint64_t last = std::uint64_t{1} << dropped_bits;
  std::vector<double> energies = lower ? lower_energy_of(ping) : energy_of(ping);
  for (double& energy : energies) {
    const auto bits = std::bit_cast<std::uint64_t>(energy);
    const std::uint64_t half = last / 2 - 1 + (bits >> dropped_bits & 1);  // ties to even
    energy = std::bit_cast<double>((bits + half) & ~(last - 1));
  }
  return energies;
}

}  // namespace tubefoot
