// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/bottom_detection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

namespace tubefoot {
namespace {

const double evenly = 1 / std::sqrt(12.0);  // standard deviation of a place anywhere in a unit length

void check(std::span<const double> energies_j, const RangeSamples& samples, const DetectionRule& rule) {
  const auto refuse = [](const std::string& what) {
    throw std::invalid_argument("bottom detection: " + what);
  };
  if (!(samples.step_m > 0 && std::isfinite(samples.step_m) && std::isfinite(samples.first_m)))
    refuse(fmt::format("samples of {} m from {} m are none", samples.step_m, samples.first_m));
  if (samples.count < 0 || energies_j.size() != static_cast<std::size_t>(samples.count))
    refuse(fmt::format("{} energies for {} samples", energies_j.size(), samples.count));
  if (!(rule.relative_db <= 0))
    refuse(fmt::format("the relative threshold is {} dB, must be 0 or less", rule.relative_db));
  if (!(rule.absolute_j >= 0))
    refuse(fmt::format("the absolute threshold is {} J, must be 0 or more", rule.absolute_j));
  if (!(rule.nearest_m <= rule.farthest_m))
    refuse(fmt::format("the range gate is {} to {} m, must not be empty", rule.nearest_m, rule.farthest_m));
  for (std::size_t k = 0; k < energies_j.size(); ++k)
    if (!(energies_j[k] >= 0 && std::isfinite(energies_j[k])))
      refuse(
          fmt::format("the energy of sample {} is {} J, must be finite and not negative", k, energies_j[k]));
}

/// The samples of a beam inside a gate: [begin, end).
struct Gate {
  std::span<const double> energies_j;
  const RangeSamples& samples;
  int begin = 0, end = 0, largest = 0;

  Gate(std::span<const double> energies, const RangeSamples& range_samples, const DetectionRule& rule)
      : energies_j(energies), samples(range_samples) {
    while (begin < samples.count && middle(begin) < rule.nearest_m) ++begin;
    end = begin;
    while (end < samples.count && middle(end) <= rule.farthest_m) ++end;
    largest = static_cast<int>(std::max_element(energies.begin() + begin, energies.begin() + end) -
                               energies.begin());
  }

  double middle(int k) const { return samples.first_m + (k + 0.5) * samples.step_m; }
  double energy(int k) const { return energies_j[static_cast<std::size_t>(k)]; }

  /// Root-mean-square distance of the energy from a range.
  double spread(double range_m) const {
    double sum = 0, moment = 0;
    for (int k = begin; k < end; ++k) {
      const double share = energy(k) / energy(largest), away = middle(k) - range_m;
      sum += share;
      moment += share * away * away;
    }
    return std::sqrt(moment / sum);
  }
};

/// Range and its standard deviation.
struct Estimate {
  double range_m, sigma_m;
};

Estimate centroid(const Gate& gate, double threshold_j) {
  // Shares of the largest energy: no sum of energies can overflow or vanish. Ranges from the largest sample.
  const double origin = gate.middle(gate.largest), within = gate.samples.step_m * evenly;
  const auto weight = [&](int k) {
    return gate.energy(k) >= threshold_j ? gate.energy(k) / gate.energy(gate.largest) : 0;
  };
  double sum = 0, moment = 0, variance = 0;
  for (int k = gate.begin; k < gate.end; ++k) {
    sum += weight(k);
    moment += weight(k) * (gate.middle(k) - origin);
  }
  const double offset = moment / sum;
  for (int k = gate.begin; k < gate.end; ++k) {
    const double w = weight(k) / sum, away = gate.middle(k) - origin - offset;
    variance += w * w * (away * away + within * within);
  }
  return {origin + offset, std::sqrt(variance)};
}

Estimate top(const Gate& gate) {
  const int k = gate.largest;
  double offset = 0;
  if (k > gate.begin && k + 1 < gate.end) {
    const double before = gate.energy(k - 1) / gate.energy(k), after = gate.energy(k + 1) / gate.energy(k);
    // The nearest of equal samples is the largest, so `before` is below 1: this never divides by 0.
    offset = (after - before) / (2 * ((1 - before) + (1 - after)));
  }
  return {gate.middle(k) + offset * gate.samples.step_m, gate.samples.step_m * evenly};
}

}  // namespace

const char* name_of(DetectionMethod method) {
  switch (method) {
    case DetectionMethod::first_return:
      return "first_return";
    case DetectionMethod::energy_centroid:
      return "energy_centroid";
    case DetectionMethod::maximum:
      return "maximum";
  }
  throw std::invalid_argument("no detection method");
}

DetectionMethod detection_method_from_name(std::string_view name) {
  for (const DetectionMethod method :
       {DetectionMethod::first_return, DetectionMethod::energy_centroid, DetectionMethod::maximum})
    if (name == name_of(method)) return method;
  throw std::invalid_argument(
      fmt::format("no detection named '{}': first_return, energy_centroid or maximum", name));
}

std::optional<Detection> detect_bottom(std::span<const double> energies_j, const RangeSamples& samples,
                                       const DetectionRule& rule) {
  check(energies_j, samples, rule);
  const Gate gate(energies_j, samples, rule);
  if (gate.begin == gate.end || gate.energy(gate.largest) == 0) return std::nullopt;
  const double threshold =
      std::max(rule.absolute_j, gate.energy(gate.largest) * std::pow(10, rule.relative_db / 10));
  if (gate.energy(gate.largest) < threshold) return std::nullopt;

  int first = gate.begin;
  while (!(gate.energy(first) >= threshold && gate.energy(first) > 0)) ++first;
  const int rests_on = rule.method == DetectionMethod::first_return ? first : gate.largest;
  const Estimate estimate = rule.method == DetectionMethod::first_return
                                ? Estimate{gate.middle(first), samples.step_m * evenly}
                            : rule.method == DetectionMethod::energy_centroid ? centroid(gate, threshold)
                                                                              : top(gate);
  Detection detection;
  detection.range_m = estimate.range_m;
  detection.range_sigma_m = estimate.sigma_m;
  const double place = std::floor((estimate.range_m - samples.first_m) / samples.step_m);
  detection.sample = std::clamp(static_cast<int>(place), gate.begin, gate.end - 1);
  detection.energy_j = gate.energy(rests_on);
  const double noise_spread = (gate.end - gate.begin) * samples.step_m * evenly;
  detection.quality = std::max(0.0, 1 - gate.spread(estimate.range_m) / noise_spread);
  return detection;
}

glm::dvec3 sounding_position(const Pose& sensor_pose, glm::dvec3 beam_axis, double range_m) {
  if (!(std::abs(glm::length(beam_axis) - 1) <= 1e-6))
    throw std::invalid_argument(
        fmt::format("sounding: the beam's axis has length {}, must be 1", glm::length(beam_axis)));
  if (!(range_m >= 0 && std::isfinite(range_m)))
    throw std::invalid_argument(
        fmt::format("sounding: the slant range is {} m, must be finite and not negative", range_m));
  return sensor_pose.position_m + sensor_pose.attitude * (range_m * beam_axis);
}

}  // namespace tubefoot
