// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

// Random numbers for the synthesis of seabeds. They result from +, -, *, / and sqrt alone, whose rounding
// IEEE 754 defines. The logarithms of mathematical libraries differ in the last bit between machines.
namespace tubefoot {

/// Returns the natural logarithm of a positive, normal number, to about one ulp.
double portable_log(double x);
/// Returns the exponential, to about one ulp, for x within +-700.
double portable_exp(double x);

/// Returns a pair of independent normal deviates (mean 0, variance 1). They depend on the arguments alone, so
/// the order of evaluation has no effect. The method is SplitMix64's finaliser over the arguments, followed
/// by Marsaglia's polar method. `stream` distinguishes the purposes of the numbers.
std::array<double, 2> normal_pair(std::uint64_t seed, std::uint64_t stream, std::int64_t i, std::int64_t j);

}  // namespace tubefoot
