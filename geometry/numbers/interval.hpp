// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

// Intervals of doubles and jets of intervals. Results are rounded outwards by more than the rounding error of
// the operations. A jet is a function of two variables over a box, with enclosures of its value and of all
// first and second derivatives.
namespace tubefoot {

struct Interval {
  double lo = 0, hi = 0;

  Interval() = default;
  Interval(double value) : lo(value), hi(value) {}  // NOLINT: exact, so as good as the number itself
  Interval(double low, double high) : lo(low), hi(high) {}

  double middle() const { return lo + (hi - lo) / 2; }
  double width() const { return hi - lo; }
  /// Upper bound of the modulus.
  double largest() const { return std::max(std::abs(lo), std::abs(hi)); }
  bool surely_positive() const { return lo > 0; }
  bool may_be_zero() const { return !(lo > 0 || hi < 0); }
  bool is_finite() const { return std::isfinite(lo) && std::isfinite(hi); }
};

/// Widens the bounds by `units` units of rounding. Returns the interval of all numbers if a bound is NaN.
inline Interval outwards(double lo, double hi, double units = 1) {
  if (!(lo <= hi)) return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  const double relative = units * 0x1p-52, least = 1e-300;
  return {lo - std::abs(lo) * relative - least, hi + std::abs(hi) * relative + least};
}

inline Interval operator-(const Interval& a) { return {-a.hi, -a.lo}; }
inline Interval operator+(const Interval& a, const Interval& b) { return outwards(a.lo + b.lo, a.hi + b.hi); }
inline Interval operator-(const Interval& a, const Interval& b) { return outwards(a.lo - b.hi, a.hi - b.lo); }
inline Interval operator*(const Interval& a, const Interval& b) {
  const double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
  if (std::isnan(p + q + r + s)) return outwards(1, 0);  // infinity times zero
  return outwards(std::min({p, q, r, s}), std::max({p, q, r, s}));
}
inline Interval operator/(const Interval& a, const Interval& b) {
  if (b.may_be_zero()) return outwards(1, 0);
  return a * outwards(1 / b.hi, 1 / b.lo);
}
inline Interval& operator+=(Interval& a, const Interval& b) { return a = a + b; }

inline Interval squared(const Interval& a) {
  const double most = a.largest(), least = a.may_be_zero() ? 0 : std::min(std::abs(a.lo), std::abs(a.hi));
  const Interval square = outwards(least * least, most * most);
  return {std::max(square.lo, 0.0), square.hi};
}
/// Returns the square root of a number that is known not to be negative; its interval may extend below zero.
inline Interval root(const Interval& a) {
  const Interval whole = outwards(std::sqrt(std::max(a.lo, 0.0)), std::sqrt(std::max(a.hi, 0.0)));
  return {std::max(whole.lo, 0.0), whole.hi};
}
// The errors of the library functions are below 4 units in the last place, in comparisons with MPFR for
// random arguments (tests/mathematics).
constexpr double library_units = 8;
inline Interval exp(const Interval& a) { return outwards(std::exp(a.lo), std::exp(a.hi), library_units); }
inline Interval log(const Interval& a) { return outwards(std::log(a.lo), std::log(a.hi), library_units); }

inline Interval hull(const Interval& a, const Interval& b) {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
}

/// A function of (a, b) over a box: value, first and second derivatives.
struct Jet {
  Interval v, a, b, aa, ab, bb;

  Jet() = default;
  Jet(double constant) : v(constant) {}           // NOLINT
  Jet(const Interval& constant) : v(constant) {}  // NOLINT
};

inline Jet operator-(const Jet& x) {
  Jet r;
  r.v = -x.v, r.a = -x.a, r.b = -x.b, r.aa = -x.aa, r.ab = -x.ab, r.bb = -x.bb;
  return r;
}
inline Jet operator+(const Jet& x, const Jet& y) {
  Jet r;
  r.v = x.v + y.v, r.a = x.a + y.a, r.b = x.b + y.b;
  r.aa = x.aa + y.aa, r.ab = x.ab + y.ab, r.bb = x.bb + y.bb;
  return r;
}
inline Jet operator-(const Jet& x, const Jet& y) { return x + -y; }
inline Jet operator*(const Jet& x, const Jet& y) {
  Jet r;
  r.v = x.v * y.v;
  r.a = x.a * y.v + x.v * y.a;
  r.b = x.b * y.v + x.v * y.b;
  r.aa = x.aa * y.v + 2.0 * (x.a * y.a) + x.v * y.aa;
  r.ab = x.ab * y.v + x.a * y.b + x.b * y.a + x.v * y.ab;
  r.bb = x.bb * y.v + 2.0 * (x.b * y.b) + x.v * y.bb;
  return r;
}
/// Returns f(x). The arguments f, f1 and f2 enclose the value and the derivatives of f over x.
inline Jet compose(const Jet& x, const Interval& f, const Interval& f1, const Interval& f2) {
  Jet r;
  r.v = f;
  r.a = f1 * x.a;
  r.b = f1 * x.b;
  r.aa = f2 * squared(x.a) + f1 * x.aa;
  r.ab = f2 * x.a * x.b + f1 * x.ab;
  r.bb = f2 * squared(x.b) + f1 * x.bb;
  return r;
}
/// Value and partial derivatives of a function of two variables.
struct Partials {
  Interval f, x, y, xx, xy, yy;
};
inline Jet compose(const Jet& x, const Jet& y, const Partials& p) {
  Jet r;
  r.v = p.f;
  r.a = p.x * x.a + p.y * y.a;
  r.b = p.x * x.b + p.y * y.b;
  r.aa = p.xx * squared(x.a) + 2.0 * (p.xy * x.a * y.a) + p.yy * squared(y.a) + p.x * x.aa + p.y * y.aa;
  r.bb = p.xx * squared(x.b) + 2.0 * (p.xy * x.b * y.b) + p.yy * squared(y.b) + p.x * x.bb + p.y * y.bb;
  r.ab = p.xx * x.a * x.b + p.xy * (x.a * y.b + x.b * y.a) + p.yy * y.a * y.b + p.x * x.ab + p.y * y.ab;
  return r;
}
inline Jet inverse(const Jet& x) {
  const Interval f = 1.0 / x.v, f1 = -squared(f);
  return compose(x, f, f1, 2.0 * (squared(f) * f));
}
inline Jet operator/(const Jet& x, const Jet& y) { return x * inverse(y); }
inline Jet squared(const Jet& x) { return compose(x, squared(x.v), 2.0 * x.v, 2.0); }
inline Jet root(const Jet& x) {
  const Interval f = root(x.v), f1 = 0.5 / f;
  return compose(x, f, f1, -0.25 / (f * x.v));
}
inline Jet log(const Jet& x) { return compose(x, log(x.v), 1.0 / x.v, -1.0 / squared(x.v)); }

}  // namespace tubefoot
