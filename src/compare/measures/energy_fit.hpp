// SPDX-License-Identifier: GPL-3.0-or-later
// Fits the numbers of another engine to the reference: gain, range exponent and offset, each with a
// standard error.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compare/measures/echo_errors.hpp"

namespace tubefoot {

/// Terms of C = gain (r / r0)^range R + offset. The slant range of the bin is r; the middle slant range of
/// the insonified bins is r0.
struct FitTerms {
  bool gain = false, range = false, offset = false;
  bool any() const { return gain || range || offset; }
};

/// Parses "gain,range,offset" in any order, each at most once. Throws UsageError.
FitTerms fit_terms(const std::string& words);

/// A value and its standard error.
struct Estimate {
  double value = 0, error = 0;
};

struct EnergyFit {
  FitTerms terms;
  double middle_range_m = 1;   ///< r0
  Estimate gain_db, exponent;  ///< 10 log10 of the gain; exponent of the range
  Estimate offset_j;           ///< noise floor or black level, in the unit of the candidate
  std::size_t cells = 0;       ///< number of patches to which gain and exponent were fitted
  /// max(C - offset, 0) / (gain (r / r0)^range) for every bin. Without the offset term, C replaces
  /// max(C - offset, 0).
  std::vector<double> fitted(const EchoPair& pair) const;
};

/// Fits the requested terms.
///
/// The offset is the mean of the candidate in the deep shadow (noise_floor.hpp). Gain and exponent are
/// fitted to the energy ratios of patches, at most 12 bands of range x 16 groups of beams. In a patch, all
/// ranges have the same weight. Patches with large deviations (a missing shadow, a shift at an edge) have
/// less weight, by Huber's weights. The standard errors come from the spread between groups of beams.
///
/// Returns nothing if the two sides have no patch in common, or if an exponent is requested and there is
/// only one band.
std::optional<EnergyFit> fit_energies(const EchoPair& pair, FitTerms terms);

}  // namespace tubefoot
