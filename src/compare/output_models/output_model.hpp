// SPDX-License-Identifier: GPL-3.0-or-later
// Conversion of reference energies to the units of another engine. It is a chain of steps, each of which
// propagates the certified bounds of the energies. See docs/engine-validation.md for the formulas.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "compare/measures/echo_errors.hpp"
#include "files/input_error.hpp"

namespace tubefoot {

/// Energy divided by the solid angle of the visible surface in the bin. The result is 0 if the solid angle is
/// less than `least_share` times the median of its row. A row consists of the bins of one ping and sample;
/// its median includes only bins with visible surfaces.
struct MeanStep {
  double least_share = 0;
};
/// Number of points in the bin, for `points_per_sr` points per steradian.
struct CountStep {
  double points_per_sr = 1;
};
/// Factor r^exponent 10^(2 alpha r / 10).
struct RangeLawStep {
  double exponent = 0, absorption_db_per_km = 0;
};
struct AmplitudeStep {};
/// 10 log10, mapped linearly from `low_db` at 0 to `high_db` at 1.
struct DecibelStep {
  double low_db = -50, high_db = 0;
};
/// Gaussian of these standard deviations, cut off to a square of `size` bins, with weights that sum to 1.
struct BlurStep {
  double beams = 1, samples = 1;
  std::int64_t size = 5;
};
/// Division by the largest value, or the sum, of the image, the row (one sample of all beams) or the beam.
struct NormaliseStep {
  std::string by = "largest", over = "image";
};
struct ClampStep {
  double low = 0, high = 1;
};
/// Rounding to the nearest of uniform steps from 0 to `full`.
struct QuantiseStep {
  std::int64_t bits = 8;
  double full = 1;
};
struct GainStep {
  double factor = 1;
};

struct OutputModelStep {
  SourcePlace place;
  std::variant<MeanStep, CountStep, RangeLawStep, AmplitudeStep, DecibelStep, BlurStep, NormaliseStep,
               ClampStep, QuantiseStep, GainStep>
      kind;
};

/// A picture with a bound of each bin: the exact value lies in value +- bound.
struct BoundedPicture {
  EchoShape shape;
  std::vector<double> value, bound;          ///< an empty bound is unknown
  std::vector<double> slant_range_bounds_m;  ///< begin and end of each sample
  /// Visible solid angle of each bin and its bound, in sr, for mean and count; empty if unknown.
  std::vector<double> solid_angle_sr, solid_angle_bound_sr;
};

/// Applies one step.
///
/// For steps that combine bins (blur, normalisation) bounds add up as absolute values. For monotone steps
/// both ends of the interval are mapped, and the larger half is the bound. Bounds exclude the rounding of
/// doubles, as the sums of docs/notes/certified-energies.md do (parts in 1e-15). Throws InputError at the
/// step for a mean or a count without solid angles.
void apply(const OutputModelStep& step, BoundedPicture& picture);

}  // namespace tubefoot
