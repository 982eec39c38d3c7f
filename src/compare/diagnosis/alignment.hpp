// SPDX-License-Identifier: GPL-3.0-or-later
// Which displacement, blur, gain and law of range make the truth look like the candidate.
#pragma once

#include <array>
#include <vector>

#include "compare/diagnosis/warp.hpp"
#include "compare/measures/energy_fit.hpp"

namespace tubefoot {

/// Two pictures to be aligned. Energies of the candidate are without its noise floor, so they may be
/// negative.
struct Pictures {
  Fan fan;
  std::vector<double> reference_j, candidate_j;
  double faintest_j = 0;      ///< candidate's unit: rows whose level is below it say nothing (8 bits, noise)
  std::size_t first_row = 0;  ///< samples before it say nothing
};

/// The parameters of a Warp that have a size and an error bar.
enum class WarpTerm { beams, samples, azimuth_scale, range_scale, tangent, beam_blur, sample_blur };
inline constexpr std::size_t warp_terms = 7;
double& value_of(Warp& warp, WarpTerm term);
double value_of(const Warp& warp, WarpTerm term);

struct Alignment {
  Warp warp;                                ///< terms that are not significant are 0
  std::array<double, warp_terms> errors{};  ///< standard errors of the terms that are not 0
  EnergyFit fit;                            ///< gain and law of range of the candidate to the warped truth
  std::vector<double> predicted_j;  ///< what the candidate would have in its own unit, but for its noise
  /// sum of differences over sum of both pictures, as the eye sees them (rows at one level, highlights
  /// compressed): before the warp, and after it.
  double misfit_before = 0, misfit = 0;
  std::size_t terms() const;  ///< that are not 0
};

/// From where coarse_warp() (coarse_search.hpp) found it: all terms together with gain and law, by Gauss and
/// Newton on the pictures with Huber's weights; error bars from the spread between patches. Terms below five
/// error bars or of no visible effect are dropped, the weakest first, and the others fitted again.
Alignment align(const Pictures& pictures, const Warp& start);

/// How far the pictures differ where they say something, under a warp and the best gain and law.
double misfit_under(const Pictures& pictures, const Warp& warp);

/// A shift alone, with its error bar, significant or not.
struct LocalEstimate {
  Estimate beams, samples;
};
LocalEstimate local_shift(const Pictures& pictures);

/// Mean of what is lit in the rows around each row (more of them where none is lit).
std::vector<double> row_levels(const EchoShape& shape, const std::vector<double>& energy_j);

}  // namespace tubefoot
