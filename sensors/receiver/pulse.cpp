// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/receiver/pulse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tubefoot {
namespace {

/// Integral, from minus infinity to `distance`, of the overlap of two intervals of length 1.
double overlap_integral(double distance) {
  if (distance <= -1) return 0;
  if (distance <= 0) return (1 + distance) * (1 + distance) / 2;
  if (distance <= 1) return 1 - (1 - distance) * (1 - distance) / 2;
  return 1;
}

/// Shares of a sample's energy that a pulse of `extent` samples distributes to that sample and the following
/// ones. The result has at most `most` shares.
std::vector<double> parts(double extent, std::size_t most) {
  if (extent <= 1)  // a separate case, because a short pulse would divide two rounding errors
    return {1 - extent / 2, extent / 2};
  std::vector<double> part;
  for (std::size_t k = 0; k < most; ++k) {
    const auto distance = static_cast<double>(k);
    if (distance >= extent + 1) break;
    part.push_back((overlap_integral(extent - distance) - overlap_integral(-distance)) / extent);
  }
  return part;
}

}  // namespace

double pulse_extent_m(double pulse_length_us, double sound_speed_m_s) {
  return sound_speed_m_s * pulse_length_us / 2e6;
}

std::vector<double> spread_over_pulse(std::span<const double> energies, const RangeSamples& samples,
                                      double extent_m) {
  const auto count = static_cast<std::size_t>(std::max(0, samples.count));
  if (count == 0 || energies.size() % count != 0)
    throw std::invalid_argument(fmt::format(
        "pulse: the number of energies, {}, is not a multiple of the number of samples per beam, {}",
        energies.size(), samples.count));
  if (!(extent_m >= 0 && std::isfinite(extent_m)))
    throw std::invalid_argument(fmt::format("pulse: the extent is {} m, but must be 0 or more", extent_m));
  const std::vector<double> part = parts(extent_m / samples.step_m, count);
  std::vector<double> spread(energies.size(), 0.0);
  for (std::size_t i = 0; i < energies.size(); ++i) {
    if (energies[i] == 0) continue;
    const std::size_t left = count - i % count;
    for (std::size_t k = 0; k < std::min(part.size(), left); ++k) spread[i + k] += energies[i] * part[k];
  }
  return spread;
}

}  // namespace tubefoot
