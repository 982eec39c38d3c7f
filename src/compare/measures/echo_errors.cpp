// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of a candidate relative to a reference: relative L1 error, RMS error in dB, energy ratio and first
// returns. It also computes shares within the bound of the reference, and the worst bins.
#include "compare/measures/echo_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace tubefoot {
namespace {

void check_lengths(const EchoPair& pair) {
  const std::size_t bins = pair.shape.bins();
  if (pair.reference_j.size() != bins || pair.candidate_j.size() != bins ||
      (!pair.bound_j.empty() && pair.bound_j.size() != bins) ||
      pair.slant_range_m.size() != pair.shape.samples)
    throw std::invalid_argument("the lengths of the compared arrays do not match their shape");
}

double sum(std::span<const double> values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// Returns part / whole. If the reference has no energy, returns `if_both_silent` or infinity.
double relative(double part, double whole, double candidate_total, double if_both_silent) {
  if (whole > 0) return part / whole;
  return candidate_total > 0 ? std::numeric_limits<double>::infinity() : if_both_silent;
}

BinPlace place_of(std::size_t bin, const EchoShape& shape) {
  return {bin / shape.samples / shape.beams, bin / shape.samples % shape.beams, bin % shape.samples};
}

WithinBound within_bound(const EchoPair& pair, double difference_j, double reference_total_j) {
  WithinBound within;
  double explained_j = 0;
  std::size_t bins = 0, inside = 0;
  for (std::size_t k = 0; k < pair.reference_j.size(); ++k) {
    const double off = std::abs(pair.candidate_j[k] - pair.reference_j[k]);
    explained_j += std::min(off, pair.bound_j[k]);
    if (pair.reference_j[k] == 0 && pair.candidate_j[k] == 0) continue;
    ++bins;
    inside += off <= pair.bound_j[k];
  }
  const double bound_j = sum(pair.bound_j);
  within.bound_l1 = relative(bound_j, reference_total_j, bound_j, 0);
  if (difference_j > 0) within.share_of_difference = explained_j / difference_j;
  if (bins > 0) within.share_of_bins = static_cast<double>(inside) / static_cast<double>(bins);
  return within;
}

std::vector<BinError> worst_bins(const EchoPair& pair, double difference_j, std::size_t count) {
  const auto off = [&](std::size_t bin) { return std::abs(pair.candidate_j[bin] - pair.reference_j[bin]); };
  std::vector<std::size_t> bins;
  for (std::size_t bin = 0; bin < pair.reference_j.size(); ++bin)
    if (off(bin) > 0) bins.push_back(bin);
  const auto end = bins.begin() + static_cast<std::ptrdiff_t>(std::min(count, bins.size()));
  std::partial_sort(bins.begin(), end, bins.end(),
                    [&](std::size_t a, std::size_t b) { return off(a) != off(b) ? off(a) > off(b) : a < b; });
  std::vector<BinError> worst;
  std::for_each(bins.begin(), end, [&](std::size_t bin) {
    const double reference_j = pair.reference_j[bin], candidate_j = pair.candidate_j[bin];
    const BinPlace place = place_of(bin, pair.shape);
    worst.push_back({place, pair.slant_range_m[place.sample], reference_j, candidate_j,
                     decibel_error(reference_j, candidate_j), off(bin) / difference_j});
  });
  return worst;
}

}  // namespace

double decibel_error(double reference_j, double candidate_j) {
  if (reference_j == candidate_j) return 0;  // includes bins that are empty on both sides
  return std::clamp(10 * std::log10(candidate_j / reference_j), -largest_error_db, largest_error_db);
}

double lit_threshold(std::span<const double> reference_j) {
  double total_j = 0;
  std::size_t bins = 0;
  for (const double energy_j : reference_j) {
    if (!(energy_j > 0)) continue;
    total_j += energy_j;
    ++bins;
  }
  constexpr double share_of_mean = 1e-3;
  return bins > 0 ? share_of_mean * total_j / static_cast<double>(bins) : 0;
}

FirstReturns first_returns(const EchoShape& shape, std::span<const double> energy_j, double threshold_j) {
  FirstReturns first(shape.pings * shape.beams);
  for (std::size_t k = 0; k < first.size(); ++k) {
    const auto beam = energy_j.subspan(k * shape.samples, shape.samples);
    const auto lit = std::find_if(beam.begin(), beam.end(), [&](double e) { return e > threshold_j; });
    if (lit != beam.end()) first[k] = static_cast<std::size_t>(lit - beam.begin());
  }
  return first;
}

FirstReturnErrors first_return_errors(const EchoPair& pair, const FirstReturns& reference,
                                      const FirstReturns& candidate) {
  FirstReturnErrors errors;
  double sum_m = 0, sum_absolute_m = 0, sum_absolute_samples = 0;
  for (std::size_t k = 0; k < reference.size(); ++k) {
    if (!reference[k] || !candidate[k]) {
      ++(reference[k]   ? errors.only_in_reference
         : candidate[k] ? errors.only_in_candidate
                        : errors.in_neither);
      continue;
    }
    const double metres = pair.slant_range_m[*candidate[k]] - pair.slant_range_m[*reference[k]];
    const auto samples =
        static_cast<std::ptrdiff_t>(*candidate[k]) - static_cast<std::ptrdiff_t>(*reference[k]);
    if (errors.in_both++ == 0 || std::abs(metres) > std::abs(errors.largest_m)) {
      errors.largest_m = metres;
      errors.largest_samples = samples;
      errors.largest_at = {k / pair.shape.beams, k % pair.shape.beams, *reference[k]};
    }
    sum_m += metres;
    sum_absolute_m += std::abs(metres);
    sum_absolute_samples += std::abs(static_cast<double>(samples));
  }
  if (errors.in_both == 0) return errors;
  const auto count = static_cast<double>(errors.in_both);
  errors.mean_m = sum_m / count;
  errors.mean_absolute_m = sum_absolute_m / count;
  errors.mean_absolute_samples = sum_absolute_samples / count;
  return errors;
}

EchoErrors echo_errors(const EchoPair& pair, std::size_t worst) {
  check_lengths(pair);
  EchoErrors errors;
  errors.reference_total_j = sum(pair.reference_j);
  errors.candidate_total_j = sum(pair.candidate_j);
  errors.lit_threshold_j = lit_threshold(pair.reference_j);
  double difference_j = 0, squares_db = 0;
  for (std::size_t k = 0; k < pair.reference_j.size(); ++k) {
    const double reference_j = pair.reference_j[k], candidate_j = pair.candidate_j[k];
    difference_j += std::abs(candidate_j - reference_j);
    if (reference_j == 0) {
      ++errors.shadow_bins;
      errors.lit_where_shadow += candidate_j > errors.lit_threshold_j;
    } else if (reference_j > errors.lit_threshold_j) {
      ++errors.lit_bins;
      errors.empty_where_lit += candidate_j == 0;
      const double error_db = decibel_error(reference_j, candidate_j);
      squares_db += error_db * error_db;
    }
  }
  errors.l1 = relative(difference_j, errors.reference_total_j, errors.candidate_total_j, 0);
  if (errors.lit_bins > 0) errors.rms_db = std::sqrt(squares_db / static_cast<double>(errors.lit_bins));
  errors.energy_ratio =
      relative(errors.candidate_total_j, errors.reference_total_j, errors.candidate_total_j, 1);
  errors.first_return =
      first_return_errors(pair, first_returns(pair.shape, pair.reference_j, errors.lit_threshold_j),
                          first_returns(pair.shape, pair.candidate_j, errors.lit_threshold_j));
  if (!pair.bound_j.empty()) errors.within_bound = within_bound(pair, difference_j, errors.reference_total_j);
  if (worst > 0) errors.worst = worst_bins(pair, difference_j, worst);
  return errors;
}

}  // namespace tubefoot
