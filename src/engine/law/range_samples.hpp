// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace tubefoot {

/// Range samples of a receiver: sample k covers slant ranges [first + k step, first + (k+1) step).
struct RangeSamples {
  double first_m = 0;
  double step_m = 0;
  int count = 0;
};

/// Borders of the range samples: first + k step, one more than samples.
std::vector<double> sample_borders_m(const RangeSamples& samples);

}  // namespace tubefoot
