// SPDX-License-Identifier: GPL-3.0-or-later
// How far one engine's energies are from another's. Pure functions over arrays: they know no file and no
// engine.
//
// Notation: R the reference and C the candidate, J per bin; B the certified half-width of R, if there is one.
// A bin is lit where its energy is above
//
//     threshold = 1e-3 * mean of R over the bins with R > 0
//
// and in shadow where R = 0. The threshold comes from the reference and serves both sides.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace tubefoot {

/// Energies lie as [ping][beam][sample].
struct EchoShape {
  std::size_t pings = 0, beams = 0, samples = 0;
  std::size_t bins() const { return pings * beams * samples; }
  bool operator==(const EchoShape&) const = default;
};

/// The two sides of a comparison. Energies are finite and not negative.
struct EchoPair {
  EchoShape shape;
  std::span<const double> reference_j, candidate_j;
  std::span<const double> bound_j;        ///< half-width of the reference, or empty; may be infinite
  std::span<const double> slant_range_m;  ///< centre per sample, increasing
};

/// A bin's place.
struct BinPlace {
  std::size_t ping = 0, beam = 0, sample = 0;
  bool operator==(const BinPlace&) const = default;
};

struct BinError {
  BinPlace place;
  double slant_range_m = 0;
  double reference_j = 0, candidate_j = 0;
  double error_db = 0;             ///< decibel_error of the two
  double share_of_difference = 0;  ///< |C - R| / sum |C - R|
};

/// What of the difference the reference's own uncertainty can explain.
struct WithinBound {
  double bound_l1 = 0;             ///< sum B / sum R: no relative L1 error below this is certain
  double share_of_difference = 1;  ///< sum min(|C - R|, B) / sum |C - R|; 1 where there is no difference
  double share_of_bins = 1;  ///< bins with |C - R| <= B, of those with R > 0 or C > 0; 1 if there are none
};

/// The first lit sample of each ping and beam, on both sides. Differences are candidate minus reference:
/// positive where the candidate's first return comes later.
struct FirstReturnErrors {
  std::size_t in_both = 0, only_in_reference = 0, only_in_candidate = 0, in_neither = 0;  ///< pings x beams
  double mean_m = 0, mean_absolute_m = 0, mean_absolute_samples = 0;  ///< over the beams with both
  double largest_m = 0;                                               ///< of the largest |difference|, signed
  std::ptrdiff_t largest_samples = 0;
  BinPlace largest_at;  ///< the reference's first return; the first such beam
};

struct EchoErrors {
  double reference_total_j = 0, candidate_total_j = 0;
  double lit_threshold_j = 0;
  std::size_t lit_bins = 0;     ///< R > threshold
  std::size_t shadow_bins = 0;  ///< R = 0
  /// sum |C - R| / sum R. Infinite where the reference is silent and the candidate is not, 0 if both are.
  double l1 = 0;
  /// sqrt(mean over lit bins of decibel_error^2); 0 without lit bins.
  double rms_db = 0;
  /// sum C / sum R; as l1, but 1 if both are silent.
  double energy_ratio = 1;
  std::size_t empty_where_lit = 0;   ///< lit bins with C = 0
  std::size_t lit_where_shadow = 0;  ///< shadow bins with C > threshold
  FirstReturnErrors first_return;
  std::optional<WithinBound> within_bound;  ///< if there is a bound
  std::vector<BinError> worst;              ///< largest |C - R| first, equal ones in the order of the bins
};

/// No bin counts for more than this, dB: a bin that is missed entirely is this much too weak.
inline constexpr double largest_error_db = 30;

/// 10 log10(candidate / reference), clamped to +-largest_error_db; 0 if both are 0.
double decibel_error(double reference_j, double candidate_j);

/// The threshold above which a bin is lit; 0 if no energy is above 0.
double lit_threshold(std::span<const double> reference_j);

/// Per ping and beam, the first return's sample, if there is one.
using FirstReturns = std::vector<std::optional<std::size_t>>;

/// The first samples with more than `threshold_j`.
FirstReturns first_returns(const EchoShape& shape, std::span<const double> energy_j, double threshold_j);

FirstReturnErrors first_return_errors(const EchoPair& pair, const FirstReturns& reference,
                                      const FirstReturns& candidate);

/// All of the above, with at most `worst` worst bins (those that differ). Throws std::invalid_argument if the
/// arrays do not have the lengths that the shape asks for.
EchoErrors echo_errors(const EchoPair& pair, std::size_t worst = 0);

}  // namespace tubefoot
