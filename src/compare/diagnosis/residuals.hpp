// SPDX-License-Identifier: GPL-3.0-or-later
// Errors that remain after gain, range dependence, displacement and blur are removed. No warp can cause
// them.
#pragma once

#include "compare/diagnosis/diagnosis.hpp"

namespace tubefoot {

/// A candidate and its prediction, both in the unit of the candidate.
struct Residual {
  const Fan& fan;
  std::span<const double> predicted_j, candidate_j;  ///< the noise floor is subtracted from the candidate
  std::vector<double> levels_j;                      ///< levels of the rows of the prediction
  std::vector<bool> dark;                            ///< the prediction is dark in this bin and around it
  std::vector<bool> row_counts;                      ///< rows in which the prediction has enough echoes
  double noise_j = 0;                                ///< energies below this value may be noise
  std::span<const double> level_curve = {};          ///< power of range and level curve; empty: 1 in all rows
  const SceneLabels* labels = nullptr;               ///< or null
};

/// Number of wrongly insonified bins of a shadow, and number of all its bins.
struct ShadowCount {
  std::size_t wrong = 0, all = 0;
};

/// Bins in which the candidate has energy although the prediction is dark, in rows with echoes of other
/// beams. The object that casts a shadow is visible if a bin right before the shadow is brighter than its
/// row, in some beams. Otherwise the object lies nearer than the picture begins.
struct WronglyLit {
  std::vector<bool> bins;
  ShadowCount behind_seen, behind_unseen;
  std::vector<ShadowCount> of_object;  ///< shadows of objects nearer than the first bin, if there are labels
};
WronglyLit wrongly_lit(const Residual& residual);

/// Smallest number of wrongly insonified bins that is an error.
inline constexpr std::size_t least_wrongly_lit = 12;

/// Range in m up to which the candidate has no echoes although the prediction has; nothing if there is no
/// such range. The level rises there in a step. The gradual rise of a vertical pattern is no such range.
std::optional<double> near_returns_missing_to(const Residual& residual);
/// Lets the rows up to near_returns_missing_to() no longer count. They contain no levels.
void leave_out_missing_rows(Residual& residual);

/// Offsets of the sides and of the ends of shadows.
EdgeOffsets shadow_sides(const Residual& residual);
EdgeOffsets shadow_ends(const Residual& residual);

/// Relative standard deviation of single bins from the prediction in uniform areas, from the median.
double scatter(const Residual& residual);

/// Quantisation steps of numbers, for example of 8 bits.
struct EvenSteps {
  std::size_t levels = 0;  ///< number of different values above 0; 0 if there are too many for steps
  double smallest = 0;     ///< smallest value above 0
  /// Share of the non-empty bins with exactly the largest value; 0 if these are fewer than 8 bins.
  double share_at_top = 0;
  const char* scale = "";  ///< scale on which steps are uniform: "energy", "amplitude", "dB"; empty for none
};
EvenSteps steps_of(std::span<const double> values);

}  // namespace tubefoot
