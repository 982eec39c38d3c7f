// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

#include "study/work_precision.hpp"

namespace tubefoot {

/// However alike the pings that were looked at: rays of another seed, and bins that nobody looked at.
inline constexpr double least_margin = 1.1;

/// One-sided: how often the other pings have no more error than error_limit() says.
inline constexpr double error_limit_confidence = 0.95;

/// What the error of the other pings of a sensor, which has `population`, will hardly exceed, from `pings`:
/// the error of these together, plus as many standard errors of the difference (by leaving out one ping at a
/// time) as error_limit_confidence takes; at least `least_margin` times the error. One ping of many tells
/// nothing of the spread: infinite, unless its error is 0.
double error_limit(std::span<const PingError> pings, std::size_t population, ErrorMeasure measure);

}  // namespace tubefoot
