// SPDX-License-Identifier: GPL-3.0-or-later
// The truth in another engine's own measure: a chain of steps on certified energies, each with its bound.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "compare/measures/echo_errors.hpp"
#include "files/input_error.hpp"

namespace tubefoot {

// The steps; docs/output models.md has their formulas.
/// Energy over the solid angle of what the bin sees; 0 where that is less than `least_share` of the median of
/// its row (the bins of that ping and sample that see something).
struct MeanStep {
  double least_share = 0;
};
/// How many of `points` a steradian fall into the bin.
struct CountStep {
  double points_per_sr = 1;
};
/// Times r^exponent 10^(2 alpha r / 10).
struct RangeLawStep {
  double exponent = 0, absorption_db_per_km = 0;
};
struct AmplitudeStep {};
/// 10 log10, from `low_db` at 0 to `high_db` at 1.
struct DecibelStep {
  double low_db = -50, high_db = 0;
};
/// A Gaussian of these deviations, cut off to a square of `size` bins whose weights sum to 1.
struct BlurStep {
  double beams = 1, samples = 1;
  std::int64_t size = 5;
};
/// Over the largest, or the sum, of the image, the row (one sample of all beams) or the beam.
struct NormaliseStep {
  std::string by = "largest", over = "image";
};
struct ClampStep {
  double low = 0, high = 1;
};
/// To even steps from 0 to `full`, nearest first.
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

/// A picture with a bound of each bin: the truth lies in value +- bound.
struct BoundedPicture {
  EchoShape shape;
  std::vector<double> value, bound;          ///< no bound known: empty
  std::vector<double> slant_range_bounds_m;  ///< begin and end of each sample
  /// Solid angle of what is seen in each bin with its bound, sr, for mean and count; empty: not known.
  std::vector<double> solid_angle_sr, solid_angle_bound_sr;
};

/// One step. Where a step is no function of the bin alone (blur, normalisation) bounds add up as absolute
/// values do; where it is monotone, both ends of the interval are mapped and the wider half is the bound.
/// Rounding of doubles is beyond the bound, as in docs/reference.md's own sums (parts in 1e-15).
/// Throws InputError at the step for a mean or a count without solid angles.
void apply(const OutputModelStep& step, BoundedPicture& picture);

}  // namespace tubefoot
