// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of the difference between the energies of two engines. Pure functions over arrays, independent
// of files and engines.
//
// Notation: R is the reference and C the candidate, in J per bin; B is the certified half-width of R, if
// present. A bin is insonified if its energy is above
//
//     threshold = 1e-3 * mean of R over the bins with R > 0
//
// and in shadow if R = 0. The threshold comes from the reference and applies to both sides.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace tubefoot {

/// Energies have the order [ping][beam][sample].
struct EchoShape {
  std::size_t pings = 0, beams = 0, samples = 0;
  std::size_t bins() const { return pings * beams * samples; }
  bool operator==(const EchoShape&) const = default;
};

/// The two sides of a comparison. Energies are finite and not negative.
struct EchoPair {
  EchoShape shape;
  std::span<const double> reference_j, candidate_j;
  std::span<const double> bound_j;        ///< half-widths of the reference, possibly infinite; or empty
  std::span<const double> slant_range_m;  ///< centre of each sample, increasing
};

/// Position of a bin.
struct BinPlace {
  std::size_t ping = 0, beam = 0, sample = 0;
  bool operator==(const BinPlace&) const = default;
};

struct BinError {
  BinPlace place;
  double slant_range_m = 0;
  double reference_j = 0, candidate_j = 0;
  double error_db = 0;             ///< decibel_error of the two energies
  double share_of_difference = 0;  ///< |C - R| / sum |C - R|
};

/// Part of the difference that the uncertainty of the reference can explain.
struct WithinBound {
  double bound_l1 = 0;             ///< sum B / sum R: no relative L1 error below this is certain
  double share_of_difference = 1;  ///< sum min(|C - R|, B) / sum |C - R|; 1 if there is no difference
  /// Bins with |C - R| <= B, as a share of those with R > 0 or C > 0; 1 if there are none.
  double share_of_bins = 1;
};

/// Errors of the first insonified sample of each ping and beam. Differences are candidate minus reference.
/// They are positive if the first return of the candidate is later.
struct FirstReturnErrors {
  /// Numbers of pairs of ping and beam.
  std::size_t in_both = 0, only_in_reference = 0, only_in_candidate = 0, in_neither = 0;
  /// Over the beams with a first return on both sides.
  double mean_m = 0, mean_absolute_m = 0, mean_absolute_samples = 0;
  double largest_m = 0;  ///< difference of largest absolute value, with its sign
  std::ptrdiff_t largest_samples = 0;
  BinPlace largest_at;  ///< first such beam, at the first return of the reference
};

struct EchoErrors {
  double reference_total_j = 0, candidate_total_j = 0;
  double lit_threshold_j = 0;
  std::size_t lit_bins = 0;     ///< number of bins with R > threshold
  std::size_t shadow_bins = 0;  ///< number of bins with R = 0
  /// sum |C - R| / sum R. Infinite if only the reference has no energy; 0 if both have none.
  double l1 = 0;
  /// sqrt(mean over insonified bins of decibel_error^2); 0 if no bin is insonified.
  double rms_db = 0;
  /// sum C / sum R. Infinite if only the reference has no energy; 1 if both have none.
  double energy_ratio = 1;
  std::size_t empty_where_lit = 0;   ///< number of insonified bins with C = 0
  std::size_t lit_where_shadow = 0;  ///< number of shadow bins with C > threshold
  FirstReturnErrors first_return;
  std::optional<WithinBound> within_bound;  ///< present if the reference has bounds
  std::vector<BinError> worst;              ///< largest |C - R| first; equal ones in the order of the bins
};

/// Largest error of a bin, in dB. A bin without any energy of the candidate has this error.
inline constexpr double largest_error_db = 30;

/// 10 log10(candidate / reference), clamped to +-largest_error_db; 0 if the two are equal.
double decibel_error(double reference_j, double candidate_j);

/// Threshold above which a bin is insonified; 0 if no energy is above 0.
double lit_threshold(std::span<const double> reference_j);

/// Sample of the first return of each ping and beam, if there is one.
using FirstReturns = std::vector<std::optional<std::size_t>>;

/// Finds the first samples with more than `threshold_j`.
FirstReturns first_returns(const EchoShape& shape, std::span<const double> energy_j, double threshold_j);

FirstReturnErrors first_return_errors(const EchoPair& pair, const FirstReturns& reference,
                                      const FirstReturns& candidate);

/// Computes all errors, with at most `worst` bins of largest error (only bins that differ). Throws
/// std::invalid_argument if the lengths of the arrays do not match the shape.
EchoErrors echo_errors(const EchoPair& pair, std::size_t worst = 0);

}  // namespace tubefoot
