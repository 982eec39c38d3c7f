// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the displacement, blur, gain and range dependence that transform the reference into the candidate.
#pragma once

#include <array>
#include <vector>

#include "compare/diagnosis/warp.hpp"
#include "compare/measures/energy_fit.hpp"

namespace tubefoot {

/// Two pictures to align. The noise floor is subtracted from the energies of the candidate, so that they
/// may be negative.
struct Pictures {
  Fan fan;
  std::vector<double> reference_j, candidate_j;
  /// In the unit of the candidate; rows of a lower level are not used (8-bit steps, noise)
  double faintest_j = 0;
  std::size_t first_row = 0;  ///< earlier samples are not used
  /// Bins whose difference no displacement causes, such as missing shadows; they are not used. Or empty.
  std::vector<bool> left_out = {};
};

/// The parameters of a Warp with a size and a standard error.
enum class WarpTerm {
  beams,
  samples,
  azimuth_scale,
  range_scale,
  tangent,
  beam_blur,
  sample_blur,
  beam_growth,
  sample_growth
};
inline constexpr std::size_t warp_terms = 9;
double& value_of(Warp& warp, WarpTerm term);
double value_of(const Warp& warp, WarpTerm term);

struct Alignment {
  Warp warp;                                ///< terms that are not significant are 0
  std::array<double, warp_terms> errors{};  ///< standard errors of the terms that are not 0
  EnergyFit fit;  ///< gain and range dependence of the candidate relative to the warped reference
  /// Factor per sample that remains after gain and range dependence: a smooth curve of a few knots.
  std::vector<double> level_curve;
  std::vector<double> predicted_j;  ///< energies of the candidate without noise, in its own unit
  /// For terms that are 0: five standard errors, or the smallest relevant size if it is larger.
  std::array<double, warp_terms> resolvable{};
  /// Sum of the differences divided by the sum of both pictures, before and after the warp.
  /// `as_seen()` prepares both pictures: rows have the same level and highlights are compressed.
  double misfit_before = 0, misfit = 0;
  std::size_t terms() const;  ///< number of terms that are not 0
};

/// A displacement must lower the misfit by this share. Otherwise it is removed.
inline constexpr double least_share_explained = 0.05;

/// Fits all terms together with the levels of the rows, starting from coarse_warp() (coarse_search.hpp).
/// The fit uses Gauss-Newton iterations with Huber weights. The standard errors come from the spread
/// between patches, and hold for errors that are correlated along rows and along beams. Terms below five
/// standard errors or without visible effect are removed, the weakest first, and the others are fitted
/// again. So are displacements that explain less than `least_share_explained` of the misfit.
Alignment align(const Pictures& pictures, const Warp& start);

/// Returns the misfit over the rows that are used, under a warp and the best gain and range exponent.
double misfit_under(const Pictures& pictures, const Warp& warp);

/// Fits a shift alone and returns it with its standard error, significant or not.
struct LocalEstimate {
  Estimate beams, samples;
};
LocalEstimate local_shift(const Pictures& pictures);

/// Returns for each row the mean of the insonified bins in the rows around it. More rows are used if none
/// is insonified.
std::vector<double> row_levels(const EchoShape& shape, const std::vector<double>& energy_j);

}  // namespace tubefoot
