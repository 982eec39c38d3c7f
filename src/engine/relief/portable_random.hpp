// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

// Numbers that a seabed is made of. They come from +, -, *, / and sqrt alone, which IEEE 754 rounds in one
// way: the mathematical library's logarithms differ in the last bit from machine to machine.
namespace tubefoot {

/// Natural logarithm of a positive, normal number, to about an ulp.
double portable_log(double x);
/// Exponential, to about an ulp; x within +-700.
double portable_exp(double x);

/// A pair of independent normal deviates (mean 0, variance 1) that depend on the arguments alone, so that no
/// order of evaluation matters: SplitMix64's finaliser over the arguments, then Marsaglia's polar method.
/// `stream` tells apart what the numbers are for.
std::array<double, 2> normal_pair(std::uint64_t seed, std::uint64_t stream, std::int64_t i, std::int64_t j);

}  // namespace tubefoot
