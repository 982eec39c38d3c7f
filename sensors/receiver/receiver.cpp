// SPDX-License-Identifier: GPL-3.0-or-later
// Applies a receiver to the energies of a simulation: speckle, thermal noise (Mellen's formula above about
// 100 kHz) and time-varied gain. Random numbers depend on seed, ping, beam and sample only.

#include "sensors/receiver/receiver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tubefoot {
namespace {

constexpr double largest_level_db = 300;  // a factor of 1e30 in energy; products stay within the range of
                                          // doubles
constexpr int most_looks = 1024;

template <typename Value>
void require(bool holds, const char* what, Value value, const char* wanted) {
  if (!holds)
    throw std::invalid_argument(fmt::format("receiver: {} is {}, but must be {}", what, value, wanted));
}

void require_level(const char* what, double level_db) {
  require(std::abs(level_db) <= largest_level_db, what, level_db, "between -300 and 300 dB");
}

double ratio(double level_db) { return std::pow(10, level_db / 10); }

void check(const TimeVariedGain& tvg) {
  require(tvg.spreading >= 0 && std::isfinite(tvg.spreading), "the spreading of the TVG", tvg.spreading,
          "a finite number, 0 or more");
  require(tvg.absorption_db_per_km >= 0 && std::isfinite(tvg.absorption_db_per_km),
          "the absorption of the TVG", tvg.absorption_db_per_km, "a finite number of dB/km, 0 or more");
  require_level("the gain of the TVG", tvg.gain_db);
  require(tvg.fixed_below_m > 0 && std::isfinite(tvg.fixed_below_m), "the nearest range of the TVG",
          tvg.fixed_below_m, "a finite number of metres above 0");
  require_level("the smallest gain of the TVG", tvg.least_db);
  require_level("the largest gain of the TVG", tvg.most_db);
  require(tvg.least_db <= tvg.most_db, "the smallest gain of the TVG", tvg.least_db,
          "at most the largest gain of the TVG");
}

}  // namespace

double thermal_noise_level_db(double frequency_khz, double bandwidth_hz, double directivity_index_db) {
  return -15 + 20 * std::log10(frequency_khz) + 10 * std::log10(bandwidth_hz) - directivity_index_db;
}

double TimeVariedGain::at(double range_m) const {
  const double range = std::max(range_m, fixed_below_m);
  const double gain = spreading * std::log10(range) + 2 * absorption_db_per_km * range / 1000 + gain_db;
  return std::clamp(gain, least_db, most_db);
}

ReceiverChain::ReceiverChain(const ReceiverDescription& description)
    : description_(description), source_upa_(std::pow(10, description.source_level_db / 20)) {
  require_level("the source level", description.source_level_db);
  const Speckle& speckle = description.speckle;
  require(speckle.looks >= 1 && speckle.looks <= most_looks, "the number of looks", speckle.looks,
          "between 1 and 1024");
  require(speckle.shape > 0 && std::isfinite(speckle.shape), "the shape of the K distribution", speckle.shape,
          "a finite number above 0");
  require(description.display_gain > 0 && std::isfinite(description.display_gain), "the display gain",
          description.display_gain, "a finite number above 0");
  require_level("the display offset", description.display_offset_db);
  if (description.tvg) check(*description.tvg);
  if (description.noise_level_db) {
    require_level("the noise level", *description.noise_level_db);
    noise_j_ = ratio(*description.noise_level_db - description.source_level_db);
  }
}

std::vector<double> ReceiverChain::gains(const RangeSamples& samples) const {
  const auto count = static_cast<std::size_t>(std::max(0, samples.count));
  std::vector<double> gains(count, 1);
  if (description_.tvg)
    for (std::size_t k = 0; k < count; ++k)
      gains[k] =
          ratio(description_.tvg->at(samples.first_m + (static_cast<double>(k) + 0.5) * samples.step_m));
  return gains;
}

std::vector<double> ReceiverChain::receive(std::uint32_t ping, std::span<const double> energies_j,
                                           std::span<const double> gains) const {
  const std::size_t per_beam = gains.size();
  if (per_beam == 0 || energies_j.size() % per_beam != 0)
    throw std::invalid_argument(fmt::format(
        "receiver: the number of energies, {}, is not a multiple of the number of samples per beam, {}",
        energies_j.size(), per_beam));
  std::vector<double> received(energies_j.size());
  for (std::size_t first = 0; first < energies_j.size(); first += per_beam)
    receive_beam(ping, static_cast<std::uint32_t>(first / per_beam), energies_j.subspan(first, per_beam),
                 gains, std::span(received).subspan(first, per_beam));
  return received;
}

void ReceiverChain::receive_beam(std::uint32_t ping, std::uint32_t beam, std::span<const double> energies_j,
                                 std::span<const double> gains, std::span<double> received_j) const {
  for (std::size_t k = 0; k < energies_j.size(); ++k) {
    if (energies_j[k] == 0 && noise_j_ == 0) {  // the case of most samples of a beam
      received_j[k] = 0;
      continue;
    }
    const auto sample = static_cast<std::uint32_t>(k);
    if (!(energies_j[k] >= 0 && std::isfinite(energies_j[k])))
      throw std::invalid_argument(
          fmt::format("receiver: the energy of ping {}, beam {}, range bin {} is {} J/m2, but must be finite "
                      "and not negative",
                      ping, beam, sample, energies_j[k]));
    const SampleRandom random(description_.seed, ping, beam, sample);
    received_j[k] =
        recorded_j(received_energy(random, description_.speckle, energies_j[k], noise_j_), gains[k]);
  }
}

void ReceiverChain::receive_lower_beam(std::uint32_t ping, std::uint32_t beam,
                                       std::span<const double> upper_j, std::span<const double> lower_j,
                                       std::span<const double> product_j, std::span<const double> gains,
                                       std::span<double> received_j) const {
  for (std::size_t k = 0; k < lower_j.size(); ++k) {
    const SampleRandom random(description_.seed, ping, beam, static_cast<std::uint32_t>(k));
    received_j[k] = recorded_j(
        lower_received_energy(random, description_.speckle, upper_j[k], lower_j[k], product_j[k], noise_j_),
        gains[k]);
  }
}

double ReceiverChain::recorded_j(double energy_j, double gain) const {
  const double amplified_j = energy_j * gain;
  if (!description_.quantiser) return amplified_j;
  const Quantiser& quantiser = *description_.quantiser;
  const std::uint16_t code = quantiser.code(description_.source_level_db + 10 * std::log10(amplified_j));
  return code == 0 ? 0 : ratio(quantiser.value(code) - description_.source_level_db);
}

double ReceiverChain::level_db(double energy_j) const {
  const double level = description_.source_level_db + 10 * std::log10(energy_j);
  return description_.display_gain * level + description_.display_offset_db;
}

}  // namespace tubefoot
