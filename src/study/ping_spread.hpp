// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

#include "study/work_precision.hpp"

namespace tubefoot {

/// Least margin, even for pings with equal errors. It accounts for other seeds of rays and for bins that
/// the pings did not contain.
inline constexpr double least_margin = 1.1;

/// One-sided confidence: the probability that the error of the other pings does not exceed error_limit().
inline constexpr double error_limit_confidence = 0.95;

/// Returns an upper confidence limit of the error of the other pings of a sensor with `population` pings,
/// from `pings`.
///
/// The limit is the error of `pings` together plus a multiple of the standard error of the difference. The
/// jackknife gives the standard error, and error_limit_confidence determines the multiple. The limit is at
/// least `least_margin` times the error. A single ping of several has no spread: the limit is infinite,
/// unless the error is 0.
double error_limit(std::span<const PingError> pings, std::size_t population, ErrorMeasure measure);

}  // namespace tubefoot
