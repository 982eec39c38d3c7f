// SPDX-License-Identifier: GPL-3.0-or-later
// Another engine's numbers brought to the reference's: gain, law of range and offset, each with an error bar.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compare/measures/echo_errors.hpp"

namespace tubefoot {

/// C = gain (r / r0)^range R + offset, r the bin's slant range and r0 the middle one of the lit bins.
struct FitTerms {
  bool gain = false, range = false, offset = false;
  bool any() const { return gain || range || offset; }
};

/// "gain,range,offset" in any order, each at most once. Throws UsageError.
FitTerms fit_terms(const std::string& words);

/// A value and its standard error.
struct Estimate {
  double value = 0, error = 0;
};

struct EnergyFit {
  FitTerms terms;
  double middle_range_m = 1;   ///< r0
  Estimate gain_db, exponent;  ///< 10 log10 of the gain; the power of r
  Estimate offset_j;           ///< in the candidate's unit: its noise floor, or its black
  std::size_t cells = 0;       ///< patches of the picture that gain and law were fitted to
  /// max(C - offset, 0) / (gain (r / r0)^range), for every bin; C itself without an offset.
  std::vector<double> fitted(const EchoPair& pair) const;
};

/// The offset is the candidate's mean in the deep shadow (noise_floor.hpp). Gain and exponent are fitted to
/// ratios of energies of patches (at most 12 bands of range x 16 groups of beams), in which the bins of each
/// range count as much as those of the others; patches far off (a missing shadow, a shift at an edge) count
/// less, by Huber's weights. Error bars from the spread between groups of beams. Nothing where the two sides
/// have no patch in common, or a law is asked for and there is only one band.
std::optional<EnergyFit> fit_energies(const EchoPair& pair, FitTerms terms);

}  // namespace tubefoot
