// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/numbers/ball.hpp"

// Functions of wide rectangles of the complex plane, with the smallest enclosing rectangles. Arb's own
// functions use an error of the same size along both axes. Computed in doubles, with a margin far larger than
// their rounding errors. This header is expensive to compile, as ball.hpp is.
namespace tubefoot {

struct ComplexRange {
  double re_lo, re_hi, im_lo, im_hi;

  explicit ComplexRange(const ComplexBall& z)
      : re_lo(z.real().lo()), re_hi(z.real().hi()), im_lo(z.imaginary().lo()), im_hi(z.imaginary().hi()) {}
  ComplexRange(double re_lo_, double re_hi_, double im_lo_, double im_hi_)
      : re_lo(re_lo_), re_hi(re_hi_), im_lo(im_lo_), im_hi(im_hi_) {}

  bool is_finite() const {
    return std::isfinite(re_lo) && std::isfinite(re_hi) && std::isfinite(im_lo) && std::isfinite(im_hi);
  }
  /// Smallest and largest distances from the axes.
  double least_im() const { return im_lo > 0 ? im_lo : im_hi < 0 ? -im_hi : 0; }
  double most_im() const { return std::max(std::abs(im_lo), std::abs(im_hi)); }
  double least_re() const { return re_lo > 0 ? re_lo : re_hi < 0 ? -re_hi : 0; }
  double most_re() const { return std::max(std::abs(re_lo), std::abs(re_hi)); }
  /// Bounds of the modulus.
  double least() const { return std::hypot(least_re(), least_im()) * (1 - 1e-14); }
  double most() const { return std::hypot(most_re(), most_im()) * (1 + 1e-14); }
  /// Upper bound of the argument's magnitude.
  double most_argument() const { return std::atan2(most_im(), re_lo) * (1 + 1e-14); }

  ComplexBall ball() const {
    const auto widened = [](double lo, double hi) {
      return Ball::between(lo - std::abs(lo) * 1e-14, hi + std::abs(hi) * 1e-14);
    };
    return {widened(re_lo, re_hi), widened(im_lo, im_hi)};
  }
};

inline ComplexBall not_finite() {
  ComplexBall result;
  acb_indeterminate(result.get());
  return result;
}

/// Returns the square root; not finite if the rectangle touches the negative axis. Let p + iq be the root of
/// x + iy. Then p increases with x and |y|, and |q| increases with |y| and decreases with x.
inline ComplexBall tight_root(const ComplexBall& z) {
  const ComplexRange in(z);
  if (!in.is_finite() || (!(in.re_lo > 0) && !(in.least_im() > 0))) return not_finite();
  const auto larger = [](double x, double y) { return std::sqrt((std::hypot(x, y) + std::abs(x)) / 2); };
  const auto p = [&](double x, double y) { return x >= 0 ? larger(x, y) : std::abs(y) / (2 * larger(x, y)); };
  const auto q = [&](double x, double y) {
    const double size = x >= 0 ? std::abs(y) / (2 * larger(x, y)) : larger(x, y);
    return std::copysign(size, y);
  };
  // q increases with y, at the x that makes it largest.
  const double lo = in.im_lo < 0 ? q(in.re_lo, in.im_lo) : q(in.re_hi, in.im_lo),
               hi = in.im_hi > 0 ? q(in.re_lo, in.im_hi) : q(in.re_hi, in.im_hi);
  return ComplexRange(p(in.re_lo, in.least_im()), p(in.re_hi, in.most_im()), lo, hi).ball();
}

/// Returns the inverse of a rectangle whose real part is positive or negative; otherwise not finite.
inline ComplexBall tight_inverse(const ComplexBall& z) {
  const ComplexRange in(z);
  if (!in.is_finite()) return not_finite();
  if (in.re_hi < 0) return -tight_inverse(-z);
  if (!(in.re_lo > 0)) return not_finite();
  // x / (x^2 + y^2) decreases with |y|. As a function of x it has one maximum, at |y|. The imaginary part has
  // the same form.
  const auto part = [](double along, double across) { return along / (along * along + across * across); };
  const double m = in.least_im(), top = in.most_im();
  const double re_hi = part(std::clamp(m, in.re_lo, in.re_hi), m),
               re_lo = std::min(part(in.re_lo, top), part(in.re_hi, top));
  const auto most_of = [&](double limit) { return part(std::min(in.re_lo, limit), in.re_lo); };
  const double down = in.im_hi > 0 ? -most_of(in.im_hi) : 0, up = in.im_lo < 0 ? most_of(-in.im_lo) : 0;
  return ComplexRange(re_lo, re_hi, down, up).ball();
}

}  // namespace tubefoot
