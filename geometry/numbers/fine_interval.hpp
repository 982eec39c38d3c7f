// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/numbers/int128.hpp"
#include "geometry/numbers/interval.hpp"

namespace tubefoot {

/// Intervals of long doubles, rounded outwards as Interval is. They serve computations with cancellation for
/// which double is too coarse. Examples are the coordinates of a small polygon far from the foot point, and
/// ranges close to a border.
struct FineInterval {
  long double lo = 0, hi = 0;

  FineInterval() = default;
  FineInterval(double value) : lo(value), hi(value) {}  // NOLINT: exact, so as good as the number itself
  explicit FineInterval(long double value) : lo(value), hi(value) {}
  FineInterval(long double low, long double high) : lo(low), hi(high) {}

  /// Encloses an integer.
  static FineInterval of(std::int64_t value);
  static FineInterval of(Int128 value);
  static FineInterval of(Int192 value);

  long double middle() const { return lo + (hi - lo) / 2; }
  bool surely_positive() const { return lo > 0; }
  bool surely_negative() const { return hi < 0; }
  bool may_be_zero() const { return !(lo > 0 || hi < 0); }

  /// Returns the interval in doubles, rounded outwards.
  Interval in_doubles() const { return tubefoot::outwards(static_cast<double>(lo), static_cast<double>(hi)); }
};

/// Returns the interval of all numbers if a bound is NaN.
inline FineInterval outwards(long double lo, long double hi) {
  using Limits = std::numeric_limits<long double>;
  if (!(lo <= hi)) return {-Limits::infinity(), Limits::infinity()};
  constexpr long double relative = 2 * Limits::epsilon(), least = 1e-300L;
  return {lo - std::abs(lo) * relative - least, hi + std::abs(hi) * relative + least};
}

inline FineInterval operator-(const FineInterval& a) { return {-a.hi, -a.lo}; }
inline FineInterval operator+(const FineInterval& a, const FineInterval& b) {
  return outwards(a.lo + b.lo, a.hi + b.hi);
}
inline FineInterval operator-(const FineInterval& a, const FineInterval& b) {
  return outwards(a.lo - b.hi, a.hi - b.lo);
}
inline FineInterval operator*(const FineInterval& a, const FineInterval& b) {
  const long double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
  if (std::isnan(p + q + r + s)) return outwards(1.0L, 0.0L);  // infinity times zero
  return outwards(std::min({p, q, r, s}), std::max({p, q, r, s}));
}
inline FineInterval operator/(const FineInterval& a, const FineInterval& b) {
  if (b.may_be_zero()) return outwards(1.0L, 0.0L);
  return a * outwards(1 / b.hi, 1 / b.lo);
}
inline FineInterval& operator+=(FineInterval& a, const FineInterval& b) { return a = a + b; }

inline FineInterval squared(const FineInterval& a) {
  const long double least = a.may_be_zero() ? 0 : std::min(std::abs(a.lo), std::abs(a.hi)),
                    most = std::max(std::abs(a.lo), std::abs(a.hi));
  const FineInterval square = outwards(least * least, most * most);
  return {std::max(square.lo, 0.0L), square.hi};
}
/// Returns the square root of a number that is known not to be negative; its interval may extend below zero.
inline FineInterval root(const FineInterval& a) {
  const FineInterval whole = outwards(std::sqrt(std::max(a.lo, 0.0L)), std::sqrt(std::max(a.hi, 0.0L)));
  return {std::max(whole.lo, 0.0L), whole.hi};
}

inline FineInterval FineInterval::of(std::int64_t value) {
  const auto near = static_cast<long double>(value);
  return outwards(near, near);
}
inline FineInterval FineInterval::of(Int128 value) {
  const auto near = static_cast<long double>(value);
  return outwards(near, near);
}
inline FineInterval FineInterval::of(Int192 value) {
  if (value.high < 0) {
    Int192 positive{~value.low, ~value.mid, ~value.high};
    positive += Int192{1, 0, 0};
    return -of(positive);
  }
  const auto part = [](std::uint64_t bits, double scale) {
    const long double near = static_cast<long double>(bits) * scale;
    return outwards(near, near);
  };
  return part(static_cast<std::uint64_t>(value.high), 0x1p128) + part(value.mid, 0x1p64) + part(value.low, 1);
}

}  // namespace tubefoot
