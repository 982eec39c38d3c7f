// SPDX-License-Identifier: GPL-3.0-or-later
// What is left of a candidate once gain, law, displacement and blur are taken from it: faults that no warp
// can make.
#pragma once

#include "compare/diagnosis/diagnosis.hpp"

namespace tubefoot {

/// A candidate and what it should be, in its own unit.
struct Residual {
  const Fan& fan;
  std::span<const double> predicted_j, candidate_j;  ///< the candidate's less its noise floor
  std::vector<double> levels_j;                      ///< of the prediction's rows
  std::vector<bool> dark;                            ///< the prediction is dark here and around
  std::vector<bool> row_counts;                      ///< rows in which the prediction has some echo
  double noise_j = 0;                                ///< below this it may be noise
};

/// Where the candidate is lit although the prediction is dark, in rows that others receive. What casts a
/// shadow is seen where something brighter than the row stands right before it, in some of its beams; else it
/// lies nearer than the picture begins.
struct WronglyLit {
  std::vector<bool> bins;
  std::size_t behind_seen = 0, behind_unseen = 0;          ///< wrongly lit
  std::size_t shadows_of_seen = 0, shadows_of_unseen = 0;  ///< bins of all shadows
};
WronglyLit wrongly_lit(const Residual& residual);

/// The range up to which the candidate has nothing although it should, m; nothing if there is none.
std::optional<double> near_returns_missing_to(const Residual& residual);

/// How far the first return's edge of each beam is off, samples, with a measure of whether neighbours are off
/// alike.
struct Scallops {
  double peak_to_peak = 0, error = 0;  ///< of the means of five neighbours
  double alikeness = 0;                ///< correlation of neighbours times the root of their number
};
Scallops scallops(const Residual& residual);

/// Offsets of the shadows' sides and ends.
EdgeOffsets shadow_sides(const Residual& residual);
EdgeOffsets shadow_ends(const Residual& residual);

/// Relative deviation of single bins from the prediction in even areas.
double scatter(const Residual& residual);

/// Steps of numbers: 8 bits and the like.
struct EvenSteps {
  std::size_t levels = 0;   ///< different values above 0; 0 where there are too many to be steps
  double smallest = 0;      ///< value above 0
  double share_at_top = 0;  ///< of the lit bins, that have the largest value exactly
  const char* scale = "";   ///< of even steps: "energy", "amplitude", "dB"; empty for none
};
EvenSteps steps_of(std::span<const double> values);

}  // namespace tubefoot
