// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/products/noise_floor.hpp"

#include <cmath>

namespace tubefoot {

std::optional<TimeVariedGain> gain_of(const Recording& recording, std::size_t sector) {
  const SignalDescription& signal = recording.sensor->description().signal;
  if (!signal.tvg_spreading) return std::nullopt;
  TimeVariedGain gain;
  gain.spreading = *signal.tvg_spreading;
  gain.absorption_db_per_km = signal.tvg_absorption_db_per_km.value_or(recording.absorption_of(sector));
  gain.gain_db = signal.tvg_gain_db;
  gain.fixed_below_m = signal.tvg_fixed_below_m;
  return gain;
}

std::vector<double> noise_floor_j(const Recording& recording, const RunContext& run, std::size_t sector) {
  constexpr double stands_out = 16;  // exp(-16) is 1 / 8.9 million
  const RangeSamples& samples = recording.sensor->samples();
  const double noise_j = receiver_of(recording, run, sector).noise_j();
  const std::optional<TimeVariedGain> gain = gain_of(recording, sector);
  std::vector<double> floor;
  for (int k = 0; k < samples.count; ++k) {
    const double gain_db = gain ? gain->at(samples.first_m + (k + 0.5) * samples.step_m) : 0;
    floor.push_back(stands_out * noise_j * std::pow(10, gain_db / 10));
  }
  return floor;
}

}  // namespace tubefoot
