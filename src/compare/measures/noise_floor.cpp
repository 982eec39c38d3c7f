// SPDX-License-Identifier: GPL-3.0-or-later
// Robust estimate of the noise of a candidate in the deep shadow of the reference, and first returns that
// single noisy bins do not affect.
#include "compare/measures/noise_floor.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tubefoot {
namespace {

/// Extends `lit` by `reach` places to both sides along an axis of `length` places with distance `stride`.
void spread(std::vector<bool>& lit, std::size_t first, std::size_t stride, std::size_t length,
            std::size_t reach) {
  std::vector<bool> wide(length);
  std::size_t until = 0;  // end of the extended region
  for (std::size_t k = 0; k < length + reach; ++k) {
    if (k < length && lit[first + k * stride]) until = k + 2 * reach + 1;
    if (k >= reach && k < until) wide[k - reach] = true;
  }
  for (std::size_t k = 0; k < length; ++k) lit[first + k * stride] = wide[k];
}

double sixtieth_percentile(std::vector<double>& values) {
  const auto rank = values.begin() + static_cast<std::ptrdiff_t>(0.6 * static_cast<double>(values.size()));
  std::nth_element(values.begin(), rank, values.end());
  return *rank;
}

/// Returns a first upper limit of the noise that ignores the strongest 40 % of the bins. It is 24 times the
/// 60th percentile, which is six standard deviations of noise clipped at 0 and more for other
/// distributions. The percentile is taken separately before the first echoes of the beams and behind them,
/// and the smaller one counts: noise is in both regions.
double first_limit(const EchoShape& shape, std::span<const double> energy_j,
                   const std::vector<bool>& shadow) {
  constexpr std::size_t least_bins = 30;
  std::vector<double> before, behind;
  for (std::size_t k = 0; k < shape.pings * shape.beams; ++k) {
    bool met = false;
    for (std::size_t bin = k * shape.samples; bin < (k + 1) * shape.samples; ++bin) {
      met = met || !shadow[bin];
      if (shadow[bin]) (met ? behind : before).push_back(energy_j[bin]);
    }
  }
  if (before.size() >= least_bins && behind.size() >= least_bins)
    return 24 * std::min(sixtieth_percentile(before), sixtieth_percentile(behind));
  before.insert(before.end(), behind.begin(), behind.end());
  return before.empty() ? 0 : 24 * sixtieth_percentile(before);
}

}  // namespace

std::vector<bool> deep_shadow(const EchoShape& shape, std::span<const double> reference_j, std::size_t beams,
                              std::size_t samples) {
  std::vector<bool> lit(shape.bins());
  for (std::size_t k = 0; k < lit.size(); ++k) lit[k] = reference_j[k] > 0;
  for (std::size_t k = 0; k < shape.pings * shape.beams; ++k)
    spread(lit, k * shape.samples, 1, shape.samples, samples);
  for (std::size_t ping = 0; ping < shape.pings && shape.beams > 2; ++ping)
    for (std::size_t sample = 0; sample < shape.samples; ++sample)
      spread(lit, ping * shape.beams * shape.samples + sample, shape.samples, shape.beams, beams);
  lit.flip();
  return lit;
}

NoiseFloor noise_floor(const EchoShape& shape, std::span<const double> energy_j,
                       const std::vector<bool>& shadow) {
  NoiseFloor floor;
  double limit = first_limit(shape, energy_j, shadow);
  for (int round = 0; round < 50; ++round) {
    // Each beam is a group, because the noise may differ between beams.
    double sum = 0, squares = 0, positive = 0;
    std::size_t bins = 0;
    double groups = 0, group_squares = 0, group_sizes = 0;
    for (std::size_t k = 0; k < shape.pings * shape.beams; ++k) {
      double of_beam = 0, count = 0;
      for (std::size_t bin = k * shape.samples; bin < (k + 1) * shape.samples; ++bin) {
        if (!shadow[bin] || energy_j[bin] > limit) continue;
        of_beam += energy_j[bin];
        squares += energy_j[bin] * energy_j[bin];
        positive += energy_j[bin] > 0;
        ++count;
      }
      if (count == 0) continue;
      sum += of_beam;
      bins += static_cast<std::size_t>(count);
      ++groups;
      group_squares += count * (of_beam / count - floor.mean_j) * (of_beam / count - floor.mean_j);
      group_sizes += count;
    }
    if (bins == 0) return {};
    const auto n = static_cast<double>(bins);
    const bool settled = bins == floor.bins;
    floor.bins = bins;
    floor.mean_j = sum / n;
    floor.deviation_j = std::sqrt(std::max(0.0, squares / n - floor.mean_j * floor.mean_j));
    floor.share_positive = positive / n;
    if (groups > 1) floor.mean_error_j = std::sqrt(group_squares / (groups - 1) / group_sizes);
    if (settled) break;
    limit = (floor.mean_j + 6 * floor.deviation_j) * (1 + 1e-9);  // the factor absorbs rounding
  }
  return floor;
}

double lit_threshold_above(const NoiseFloor& floor, std::span<const double> energy_j) {
  const double noise_j = floor.mean_j + 4 * floor.deviation_j;
  double total = 0, bins = 0;
  for (const double e : energy_j) {
    if (!(e > noise_j)) continue;
    total += e - noise_j;
    ++bins;
  }
  return noise_j + (bins > 0 ? 1e-3 * total / bins : 0);
}

std::vector<double> mean_of_frames(const EchoShape& shape, std::span<const double> energy_j,
                                   std::size_t frames) {
  if (frames == 0 || shape.pings % frames != 0)
    throw std::invalid_argument("the number of averaged frames does not divide the number of pings");
  const std::size_t bins = shape.beams * shape.samples;
  std::vector<double> mean(shape.pings / frames * bins);
  for (std::size_t ping = 0; ping < shape.pings; ++ping)
    for (std::size_t bin = 0; bin < bins; ++bin)
      mean[ping / frames * bins + bin] += energy_j[ping * bins + bin] / static_cast<double>(frames);
  return mean;
}

FirstReturns steady_first_returns(const EchoShape& shape, std::span<const double> energy_j,
                                  double threshold_j, bool single) {
  if (single) return first_returns(shape, energy_j, threshold_j);
  FirstReturns first(shape.pings * shape.beams);
  for (std::size_t k = 0; k < first.size(); ++k) {
    const auto beam = energy_j.subspan(k * shape.samples, shape.samples);
    const auto lit = [&](std::size_t s) { return s < beam.size() && beam[s] > threshold_j; };
    for (std::size_t s = 0; s < beam.size() && !first[k]; ++s)
      if (lit(s) && (lit(s + 1) || lit(s + 2))) first[k] = s;
  }
  return first;
}

}  // namespace tubefoot
