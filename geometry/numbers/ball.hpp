// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <limits>
#include <utility>

#include "geometry/numbers/arb.hpp"

// Real and complex balls: numbers known to lie within a radius of a midpoint. Every operation encloses all
// values that its operands may have (F. Johansson, Arb). This header is expensive to compile: include it only
// in .cpp files and in headers that need it for their own interface.
namespace tubefoot {

/// Working precision in bits. A slab of a millimetre at a kilometre keeps 30 digits, which suffices for all
/// uses in tubefoot.
constexpr slong ball_bits = 128;

class Ball {
 public:
  Ball() { arb_init(x_); }
  Ball(double value) : Ball() { arb_set_d(x_, value); }  // NOLINT: exact, so as good as the number itself
  explicit Ball(long double value) : Ball(static_cast<double>(value)) {  // exact, in two parts
    const Ball rest(static_cast<double>(value - static_cast<double>(value)));
    arb_add(x_, x_, rest.x_, ball_bits);
  }
  explicit Ball(int value) : Ball(static_cast<double>(value)) {}
  Ball(const Ball& o) : Ball() { arb_set(x_, o.x_); }
  Ball(Ball&& o) noexcept : Ball() { arb_swap(x_, o.x_); }
  Ball& operator=(Ball o) noexcept {
    arb_swap(x_, o.x_);
    return *this;
  }
  ~Ball() { arb_clear(x_); }

  static Ball pi() {
    Ball result;
    arb_const_pi(result.x_, ball_bits);
    return result;
  }
  static Ball between(double lo, double hi) {
    Ball result, lower(lo), upper(hi);
    arb_union(result.x_, lower.x_, upper.x_, ball_bits);
    return result;
  }

  arb_ptr get() { return x_; }
  arb_srcptr get() const { return x_; }

  double middle() const { return arf_get_d(arb_midref(x_), ARF_RND_NEAR); }
  /// Bounds, rounded outwards.
  double lo() const { return bound(ARF_RND_FLOOR); }
  double hi() const { return bound(ARF_RND_CEIL); }
  long double fine_lo() const { return fine_bound(-1); }
  long double fine_hi() const { return fine_bound(1); }
  bool is_finite() const { return arb_is_finite(x_); }
  bool surely_positive() const { return arb_is_positive(x_); }
  bool surely_negative() const { return arb_is_negative(x_); }
  bool may_be_zero() const { return arb_contains_zero(x_); }
  /// Returns the midpoint as a ball of radius 0.
  Ball centre() const {
    Ball result;
    arb_get_mid_arb(result.x_, x_);
    return result;
  }
  /// Widens the ball by an error of at most `radius`.
  void add_error(const Ball& radius) { arb_add_error(x_, radius.x_); }

  Ball operator-() const {
    Ball result;
    arb_neg(result.x_, x_);
    return result;
  }
  friend Ball operator+(const Ball& a, const Ball& b) { return of(arb_add, a, b); }
  friend Ball operator-(const Ball& a, const Ball& b) { return of(arb_sub, a, b); }
  friend Ball operator*(const Ball& a, const Ball& b) { return of(arb_mul, a, b); }
  friend Ball operator/(const Ball& a, const Ball& b) { return of(arb_div, a, b); }
  Ball& operator+=(const Ball& b) {
    arb_add(x_, x_, b.x_, ball_bits);
    return *this;
  }
  friend Ball atan2(const Ball& y, const Ball& x) { return of(arb_atan2, y, x); }

 private:
  static Ball of(void (*f)(arb_t, const arb_t, const arb_t, slong), const Ball& a, const Ball& b) {
    Ball result;
    f(result.x_, a.x_, b.x_, ball_bits);
    return result;
  }
  double bound(arf_rnd_t rounding) const {
    if (!arb_is_finite(x_))
      return std::numeric_limits<double>::infinity() * (rounding == ARF_RND_FLOOR ? -1 : 1);
    arf_t end;
    arf_init(end);
    if (rounding == ARF_RND_FLOOR)
      arb_get_lbound_arf(end, x_, ball_bits);
    else
      arb_get_ubound_arf(end, x_, ball_bits);
    const double result = arf_get_d(end, rounding);
    arf_clear(end);
    return result;
  }
  long double fine_bound(int side) const {
    const long double outside = side * std::numeric_limits<long double>::infinity();
    if (!arb_is_finite(x_)) return outside;
    arf_t end;
    arf_init(end);
    if (side < 0)
      arb_get_lbound_arf(end, x_, ball_bits);
    else
      arb_get_ubound_arf(end, x_, ball_bits);
    const double most = arf_get_d(end, ARF_RND_NEAR);
    arf_t rest, head;
    arf_init(rest);
    arf_init_set_ui(head, 0);
    arf_set_d(head, most);
    arf_sub(rest, end, head, ARF_PREC_EXACT, ARF_RND_DOWN);
    const double little = arf_get_d(rest, side < 0 ? ARF_RND_FLOOR : ARF_RND_CEIL);
    long double result = most;
    if (little != 0) result = std::nextafter(result + little, outside);  // for the rounding of the sum
    arf_clear(head);
    arf_clear(rest);
    arf_clear(end);
    return result;
  }
  arb_t x_;
};

/// Returns the sign, or 0 if the ball contains 0.
inline int sign(const Ball& x) { return x.surely_positive() ? 1 : x.surely_negative() ? -1 : 0; }
inline Ball hull(const Ball& a, const Ball& b) {
  Ball result;
  arb_union(result.get(), a.get(), b.get(), ball_bits);
  return result;
}
inline Ball squared(const Ball& x) { return x * x; }
/// Returns the square root of a number that is known not to be negative; its ball may extend below zero.
inline Ball root(const Ball& x) {
  Ball result;
  arb_sqrtpos(result.get(), x.get(), ball_bits);
  return result;
}
inline Ball exp(const Ball& x) {
  Ball result;
  arb_exp(result.get(), x.get(), ball_bits);
  return result;
}
inline Ball log(const Ball& x) {
  Ball result;
  arb_log(result.get(), x.get(), ball_bits);
  return result;
}
inline Ball atan(const Ball& x) {
  Ball result;
  arb_atan(result.get(), x.get(), ball_bits);
  return result;
}

/// A rectangle of the complex plane. The result of a function with branch cuts is not finite if the rectangle
/// touches a cut.
class ComplexBall {
 public:
  ComplexBall() { acb_init(x_); }
  ComplexBall(const Ball& re) : ComplexBall() { arb_set(acb_realref(x_), re.get()); }  // NOLINT
  ComplexBall(double re) : ComplexBall() { arb_set_d(acb_realref(x_), re); }           // NOLINT
  ComplexBall(const Ball& re, const Ball& im) : ComplexBall(re) { arb_set(acb_imagref(x_), im.get()); }
  ComplexBall(const ComplexBall& o) : ComplexBall() { acb_set(x_, o.x_); }
  ComplexBall(ComplexBall&& o) noexcept : ComplexBall() { acb_swap(x_, o.x_); }
  ComplexBall& operator=(ComplexBall o) noexcept {
    acb_swap(x_, o.x_);
    return *this;
  }
  ~ComplexBall() { acb_clear(x_); }

  acb_ptr get() { return x_; }
  acb_srcptr get() const { return x_; }
  Ball real() const { return part(acb_realref(x_)); }
  Ball imaginary() const { return part(acb_imagref(x_)); }
  bool is_finite() const { return acb_is_finite(x_); }
  /// Upper bound of the modulus.
  double largest() const {
    Ball modulus;
    acb_abs(modulus.get(), x_, ball_bits);
    return modulus.hi();
  }

  ComplexBall operator-() const {
    ComplexBall result;
    acb_neg(result.x_, x_);
    return result;
  }
  friend ComplexBall operator+(const ComplexBall& a, const ComplexBall& b) { return of(acb_add, a, b); }
  friend ComplexBall operator-(const ComplexBall& a, const ComplexBall& b) { return of(acb_sub, a, b); }
  friend ComplexBall operator*(const ComplexBall& a, const ComplexBall& b) { return of(acb_mul, a, b); }
  friend ComplexBall operator/(const ComplexBall& a, const ComplexBall& b) { return of(acb_div, a, b); }
  ComplexBall& operator+=(const ComplexBall& b) {
    acb_add(x_, x_, b.x_, ball_bits);
    return *this;
  }

 private:
  static ComplexBall of(void (*f)(acb_t, const acb_t, const acb_t, slong), const ComplexBall& a,
                        const ComplexBall& b) {
    ComplexBall result;
    f(result.x_, a.x_, b.x_, ball_bits);
    return result;
  }
  static Ball part(const arb_t x) {
    Ball result;
    arb_set(result.get(), x);
    return result;
  }
  acb_t x_;
};

inline ComplexBall hull(const ComplexBall& a, const ComplexBall& b) {
  ComplexBall result;
  acb_union(result.get(), a.get(), b.get(), ball_bits);
  return result;
}
inline ComplexBall squared(const ComplexBall& x) { return x * x; }
inline ComplexBall root(const ComplexBall& x) {
  ComplexBall result;
  acb_sqrt_analytic(result.get(), x.get(), 1, ball_bits);
  return result;
}
inline ComplexBall exp(const ComplexBall& x) {
  ComplexBall result;
  acb_exp(result.get(), x.get(), ball_bits);
  return result;
}
inline ComplexBall atan(const ComplexBall& x) {
  ComplexBall result;
  // The branch cuts are +-i (1, infinity).
  const bool cut = x.real().may_be_zero() && !(x.imaginary().hi() < 1 && x.imaginary().lo() > -1);
  if (cut || !x.is_finite())
    acb_indeterminate(result.get());
  else
    acb_atan(result.get(), x.get(), ball_bits);
  return result;
}
/// Returns sin(x) / x, and 1 for 0.
inline ComplexBall sinc(const ComplexBall& x) {
  ComplexBall result;
  acb_sinc(result.get(), x.get(), ball_bits);
  return result;
}
inline void sin_cos(const ComplexBall& x, ComplexBall& sine, ComplexBall& cosine) {
  acb_sin_cos(sine.get(), cosine.get(), x.get(), ball_bits);
}
inline void sin_cos(const Ball& x, Ball& sine, Ball& cosine) {
  arb_sin_cos(sine.get(), cosine.get(), x.get(), ball_bits);
}

}  // namespace tubefoot
