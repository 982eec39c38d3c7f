// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace tubefoot {

/// Range samples of a receiver: sample k covers slant ranges [first + k step, first + (k+1) step).
struct RangeSamples {
  double first_m = 0;
  double step_m = 0;
  int count = 0;

  /// Returns the start of sample k. All code uses this function, so that the digits agree.
  double border_m(double k) const { return first_m + k * step_m; }
};

/// Returns the borders of the range samples, one more than samples.
std::vector<double> sample_borders_m(const RangeSamples& samples);

}  // namespace tubefoot
