// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/relief/portable_random.hpp"

#include <cmath>

namespace tubefoot {
namespace {

constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15u;

std::uint64_t mix(std::uint64_t h) {
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
  return h ^ (h >> 31);
}

// Returns a number in (-1, 1), an odd multiple of 2^-53.
double symmetric(std::uint64_t h) { return (static_cast<double>(h >> 12) + 0.5) * 0x1p-51 - 1; }

}  // namespace

double portable_log(double x) {
  int exponent = 0;
  double m = std::frexp(x, &exponent);  // in [1/2, 1)
  if (m < 0.70710678118654752) {
    m *= 2;
    --exponent;
  }
  // 2 artanh t; t^2 is below 0.0295, so the first omitted term is below 2^-56 of the sum.
  const double t = (m - 1) / (m + 1), square = t * t;
  double sum = 0;
  for (int n = 21; n >= 3; n -= 2) sum = (sum + 1.0 / n) * square;
  constexpr double high = 0x1.62e42fefa38p-1, low = 0x1.ef35793c7673p-45;  // ln 2 in two parts
  return exponent * high + (exponent * low + (2 * t + 2 * t * sum));
}

double portable_exp(double x) {
  constexpr double high = 0x1.62e42fefa38p-1, low = 0x1.ef35793c7673p-45;
  const double n = std::floor(x / high + 0.5);
  const double r = (x - n * high) - n * low;  // within +-0.35
  double sum = 1;
  for (int k = 14; k >= 1; --k) sum = 1 + sum * r / k;
  return std::ldexp(sum, static_cast<int>(n));
}

std::array<double, 2> normal_pair(std::uint64_t seed, std::uint64_t stream, std::int64_t i, std::int64_t j) {
  std::uint64_t state = seed;
  for (const std::uint64_t part : {stream, static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(j)})
    state = mix((state ^ part) + kGolden);
  for (;;) {
    const double u = symmetric(mix(state += kGolden)), v = symmetric(mix(state += kGolden));
    const double s = u * u + v * v;
    if (s >= 1) continue;
    const double scale = std::sqrt(-2 * portable_log(s) / s);
    return {u * scale, v * scale};
  }
}

}  // namespace tubefoot
