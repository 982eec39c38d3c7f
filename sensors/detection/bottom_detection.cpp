// SPDX-License-Identifier: GPL-3.0-or-later
// Detects the bottom in the energies of one beam: first return, energy centroid or maximum. The samples
// above the thresholds form echoes, which wide gaps separate; the method selects one echo and estimates its
// range.

#include "sensors/detection/bottom_detection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "sensors/receiver/lit_samples.hpp"

namespace tubefoot {
namespace {

const double evenly = 1 / std::sqrt(12.0);  // standard deviation of a uniform position in a unit length

void check(std::span<const double> energies_j, const LitSpan& lit, const RangeSamples& samples,
           const DetectionRule& rule) {
  const auto refuse = [](const std::string& what) {
    throw std::invalid_argument("bottom detection: " + what);
  };
  if (!(samples.step_m > 0 && std::isfinite(samples.step_m) && std::isfinite(samples.first_m)))
    refuse(fmt::format("invalid range samples: step {} m, first {} m", samples.step_m, samples.first_m));
  if (samples.count < 0 || energies_j.size() != static_cast<std::size_t>(samples.count))
    refuse(fmt::format("there are {} energies, but {} range samples", energies_j.size(), samples.count));
  if (rule.method == DetectionMethod::split_beam)
    refuse("split-beam detection needs phases, which energies do not have: use energy_centroid");
  if (!(rule.relative_db <= 0))
    refuse(fmt::format("the relative threshold is {} dB, but must be 0 or less", rule.relative_db));
  if (!(rule.absolute_j >= 0))
    refuse(fmt::format("the absolute threshold is {} J/m2, but must be 0 or more", rule.absolute_j));
  if (!(rule.nearest_m <= rule.farthest_m))
    refuse(
        fmt::format("the range gate is {} to {} m, but must not be empty", rule.nearest_m, rule.farthest_m));
  for (std::size_t k = lit.begin; k < lit.end; ++k)
    if (!(energies_j[k] >= 0 && std::isfinite(energies_j[k])))
      refuse(fmt::format("the energy of sample {} is {} J/m2, but must be finite and not negative", k,
                         energies_j[k]));
}

/// The samples of a beam inside a gate: [begin, end).
struct Gate {
  std::span<const double> energies_j;
  const RangeSamples& samples;
  int begin = 0, end = 0;
  int lit_begin = 0, lit_end = 0;  ///< from the first to the last of these samples with energy
  int largest = 0;                 ///< sample of the largest energy

  Gate(std::span<const double> energies, const LitSpan& lit, const RangeSamples& range_samples,
       const DetectionRule& rule)
      : energies_j(energies), samples(range_samples) {
    begin = first_that(0, [&](int k) { return middle(k) >= rule.nearest_m; });
    end = first_that(begin, [&](int k) { return middle(k) > rule.farthest_m; });
    lit_begin = std::clamp(static_cast<int>(lit.begin), begin, end);
    lit_end = std::clamp(static_cast<int>(lit.end), lit_begin, end);
    largest = static_cast<int>(std::max_element(energies.begin() + lit_begin, energies.begin() + lit_end) -
                               energies.begin());
  }
  /// Index of the first sample from `from` on that is far enough, or samples.count if none is.
  int first_that(int from, const auto& is_far_enough) const {
    int to = samples.count;
    while (from < to) {
      const int between = from + (to - from) / 2;
      if (is_far_enough(between))
        to = between;
      else
        from = between + 1;
    }
    return from;
  }
  bool is_silent() const { return lit_begin == lit_end || energy(largest) == 0; }

  double middle(int k) const { return samples.first_m + (k + 0.5) * samples.step_m; }
  double energy(int k) const { return energies_j[static_cast<std::size_t>(k)]; }

  /// Root-mean-square distance of the energy from a range.
  double spread(double range_m) const {
    double sum = 0, moment = 0;
    for (int k = lit_begin; k < lit_end; ++k) {
      const double share = energy(k) / energy(largest), away = middle(k) - range_m;
      sum += share;
      moment += share * away * away;
    }
    return std::sqrt(moment / sum);
  }
};

/// Samples above the thresholds that belong together: [begin, end). The first and the last sample are above
/// the thresholds.
struct GatedEcho {
  int begin, end;
  double energy;  ///< sum over the samples above the thresholds, relative to the gate's largest sample
  int gap;        ///< widest gap between samples above the thresholds
};

/// The samples of a gate above the thresholds, and the gaps that separate them.
class Counted {
 public:
  Counted(const Gate& gate, double threshold_j) : gate_(gate) {
    for (int k = gate.lit_begin; k < gate.lit_end; ++k)
      if (gate.energy(k) > 0 && gate.energy(k) >= threshold_j) places_.push_back(k);
  }
  bool has(int k) const { return std::binary_search(places_.begin(), places_.end(), k); }
  int first() const { return places_.front(); }

  /// The selected echo, and the energy of the strongest other echo.
  struct Choice {
    GatedEcho echo;
    double next_energy = 0;
  };
  /// Selects the part that contains the sample `holding`, or without it the part of more energy.
  Choice choose(std::optional<int> holding) const {
    Choice choice{};
    std::size_t from = 0, to = places_.size();
    for (;;) {
      std::size_t middle = from,
                  smaller = 0;  // index at which the widest gap ends, and number of samples on its smaller
                                // side
      int gap = 0;
      for (std::size_t k = from + 1; k < to; ++k) {
        const int own = places_[k] - places_[k - 1] - 1;
        const std::size_t lesser = std::min(k - from, to - k);
        if (own < gap || (own == gap && lesser <= smaller)) continue;
        gap = own;
        middle = k;
        smaller = lesser;
      }
      if (static_cast<std::size_t>(gap) <= smaller) break;
      const double near = energy(from, middle), far = energy(middle, to);
      const bool nearer = holding ? *holding < places_[middle] : near >= far;
      (nearer ? to : from) = middle;
      choice.next_energy = std::max(choice.next_energy, nearer ? far : near);
    }
    int widest = 0;
    for (std::size_t k = from + 1; k < to; ++k) widest = std::max(widest, places_[k] - places_[k - 1] - 1);
    choice.echo = {places_[from], places_[to - 1] + 1, energy(from, to), widest};
    return choice;
  }

 private:
  /// Energies are fractions of the largest one, so that their sums neither overflow nor vanish.
  double energy(std::size_t from, std::size_t to) const {
    double sum = 0;
    for (std::size_t k = from; k < to; ++k) sum += gate_.energy(places_[k]) / gate_.energy(gate_.largest);
    return sum;
  }

  const Gate& gate_;
  std::vector<int> places_;  ///< samples above the thresholds
};

/// A range and its standard deviation.
struct Estimate {
  double range_m, sigma_m;
};

Estimate centroid(const Gate& gate, const Counted& counted, const GatedEcho& echo) {
  // Ranges are relative to the largest sample.
  const double origin = gate.middle(gate.largest), within = gate.samples.step_m * evenly;
  double moment = 0, variance = 0;
  const auto each = [&](auto use) {
    for (int k = echo.begin; k < echo.end; ++k)
      if (counted.has(k))
        use(gate.energy(k) / gate.energy(gate.largest) / echo.energy, gate.middle(k) - origin);
  };
  each([&](double share, double away) { moment += share * away; });
  each([&](double share, double away) {
    variance += share * share * ((away - moment) * (away - moment) + within * within);
  });
  return {origin + moment, std::sqrt(variance)};
}

/// Returns a range in the echo and the sample that contains it. If that sample is below the thresholds, it
/// returns the middle of the nearest sample above them. For two samples at equal distance it selects the one
/// of smaller range.
std::pair<double, int> onto_energy(double range_m, const Gate& gate, const Counted& counted,
                                   const GatedEcho& echo) {
  const RangeSamples& samples = gate.samples;
  const auto border = [&](int k) { return samples.first_m + k * samples.step_m; };
  const int place = std::clamp(static_cast<int>(std::floor((range_m - samples.first_m) / samples.step_m)),
                               echo.begin, echo.end - 1);
  if (counted.has(place)) return {range_m, place};
  int before = place, after = place;
  while (!counted.has(before)) --before;
  while (!counted.has(after)) ++after;
  if (range_m - border(before + 1) <= border(after) - range_m) return {gate.middle(before), before};
  return {gate.middle(after), after};
}

Estimate top(const Gate& gate) {
  const int k = gate.largest;
  double offset = 0;
  if (k > gate.begin && k + 1 < gate.end) {
    const double before = gate.energy(k - 1) / gate.energy(k), after = gate.energy(k + 1) / gate.energy(k);
    // The largest sample is the nearest of equal ones. So `before` is below 1, and the divisor is not 0.
    offset = (after - before) / (2 * ((1 - before) + (1 - after)));
  }
  return {gate.middle(k) + offset * gate.samples.step_m, gate.samples.step_m * evenly};
}

}  // namespace

const char* name_of(DetectionFlags flags) {
  const bool cut = flags.has(DetectionFlag::cut_by_window), more = flags.has(DetectionFlag::several_echoes);
  return cut && more ? "cut_by_window+several_echoes"
         : cut       ? "cut_by_window"
         : more      ? "several_echoes"
                     : "good";
}

const char* name_of(DetectionMethod method) {
  switch (method) {
    case DetectionMethod::first_return:
      return "first_return";
    case DetectionMethod::energy_centroid:
      return "energy_centroid";
    case DetectionMethod::maximum:
      return "maximum";
    case DetectionMethod::split_beam:
      return "split_beam";
  }
  throw std::invalid_argument("no detection method");
}

DetectionMethod detection_method_from_name(std::string_view name) {
  for (const DetectionMethod method :
       {DetectionMethod::first_return, DetectionMethod::energy_centroid, DetectionMethod::maximum})
    if (name == name_of(method)) return method;
  throw std::invalid_argument(
      fmt::format("unknown detection method '{}': expected first_return, energy_centroid or maximum", name));
}

std::optional<Detection> detect_bottom(std::span<const double> energies_j, const RangeSamples& samples,
                                       const DetectionRule& rule) {
  const LitSpan lit = lit_samples(energies_j);
  check(energies_j, lit, samples, rule);
  const Gate gate(energies_j, lit, samples, rule);
  if (gate.is_silent()) return std::nullopt;
  const double threshold =
      std::max(rule.absolute_j, gate.energy(gate.largest) * std::pow(10, rule.relative_db / 10));
  if (gate.energy(gate.largest) < threshold) return std::nullopt;

  const Counted counted(gate, threshold);
  const auto [echo, next_energy] =
      counted.choose(rule.method == DetectionMethod::first_return ? std::optional(counted.first())
                     : rule.method == DetectionMethod::maximum    ? std::optional(gate.largest)
                                                                  : std::nullopt);
  Detection detection;
  switch (rule.method) {
    case DetectionMethod::first_return:
      detection.sample = counted.first();
      detection.range_m = gate.middle(detection.sample);
      detection.range_sigma_m = samples.step_m * evenly;
      detection.energy_j = gate.energy(detection.sample);
      break;
    case DetectionMethod::energy_centroid: {
      const Estimate mean = centroid(gate, counted, echo);
      std::tie(detection.range_m, detection.sample) = onto_energy(mean.range_m, gate, counted, echo);
      detection.range_sigma_m = mean.sigma_m;
      // The centroid lies between two echoes without a separating gap, and the result is the range of one of
      // them.
      if (std::abs(detection.range_m - mean.range_m) > 2 * samples.step_m)
        detection.flags.set(DetectionFlag::several_echoes);
      for (int k = echo.begin; k < echo.end; ++k)
        detection.energy_j = std::max(detection.energy_j, gate.energy(k));
      break;
    }
    case DetectionMethod::maximum: {
      const Estimate peak = top(gate);
      detection.range_m = peak.range_m;
      detection.sample = gate.largest;
      detection.range_sigma_m = peak.sigma_m;
      detection.energy_j = gate.energy(gate.largest);
      break;
    }
    case DetectionMethod::split_beam:  // rejected above
      break;
  }
  // An echo at the border of the gate continues outside, for any method. Samples outside may be as weak as
  // gaps within the echo.
  const int faded = std::max(1, echo.gap);
  if (echo.begin - gate.begin <= faded || gate.end - echo.end <= faded)
    detection.flags.set(DetectionFlag::cut_by_window);
  constexpr double worth_telling = 0.1;
  if (next_energy >= worth_telling * echo.energy) detection.flags.set(DetectionFlag::several_echoes);
  const double noise_spread = (gate.end - gate.begin) * samples.step_m * evenly;
  detection.quality = std::max(0.0, 1 - gate.spread(detection.range_m) / noise_spread);
  return detection;
}

glm::dvec3 sounding_position(const Pose& sensor_pose, glm::dvec3 beam_axis, double range_m) {
  if (!(std::abs(glm::length(beam_axis) - 1) <= 1e-6))
    throw std::invalid_argument(
        fmt::format("sounding: the beam axis has length {}, but must have length 1", glm::length(beam_axis)));
  if (!(range_m >= 0 && std::isfinite(range_m)))
    throw std::invalid_argument(
        fmt::format("sounding: the slant range is {} m, but must be finite and not negative", range_m));
  return sensor_pose.position_m + sensor_pose.attitude * (range_m * beam_axis);
}

}  // namespace tubefoot
