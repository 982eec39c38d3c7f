// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace tubefoot {

/// Returns the number of at most 12 significant digits that differs from `value` only by rounding, for
/// example 60 for 59.99999999999999. Without such a number, the result is `value`. -0 becomes 0.
/// `magnitude`: of the numbers from which `value` was computed, if they are larger.
inline double plain(double value, double magnitude = 0) {
  if (!std::isfinite(value)) return value;
  constexpr int most_digits = 12;
  // Sums, and conversions between degrees and radians, round by a few units in the last place.
  const double rounding =
      8 * std::numeric_limits<double>::epsilon() * std::max(std::abs(value), std::abs(magnitude));
  if (std::abs(value) <= rounding) return 0;
  for (int digits = 1; digits <= most_digits; ++digits) {
    const double rounded = std::strtod(fmt::format("{:.{}e}", value, digits - 1).c_str(), nullptr);
    if (std::abs(rounded - value) <= rounding) return rounded;
  }
  return value;
}

}  // namespace tubefoot
