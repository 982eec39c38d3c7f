// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "geometry/integrals/interval_polygon.hpp"
#include "geometry/integrals/polar_slabs.hpp"
#include "geometry/numbers/ball.hpp"
#include "geometry/numbers/dual.hpp"

// The number types of PolarPolygon, PolarArcs and PolarIntegrand. Each class states the operations that
// differ between number types. Every other operation is the same formula for all of them. This header is
// expensive to compile, as ball.hpp is.
namespace tubefoot {

/// Intervals: long doubles for coordinates, doubles for angles and for the integrand.
struct IntervalNumbers {
  using Fine = FineInterval;
  using Number = Interval;
  /// Whether the constant part of an arc is summed once. Then arcs need fewer operations.
  static constexpr bool constants_apart = true;

  static Interval number(const FineInterval& x) { return x.in_doubles(); }
  static RangeEnclosure enclosure(const FineInterval& x) { return {x.lo, x.hi}; }
  static double upper(const Interval& x) { return x.hi; }
  static const Interval& pi() {
    static const Interval value = outwards(std::numbers::pi, std::numbers::pi);
    return value;
  }
  static const Interval& two_pi() {
    static const Interval value = 2.0 * pi();
    return value;
  }
  static bool is_direction(const Interval& angle) { return angle.width() < 0.5; }

  static std::array<FineInterval, 2> direction(const FineInterval& x, const FineInterval& y,
                                               const FineInterval& length) {
    const FineInterval per_length = FineInterval(1.0) / length;
    return {x * per_length, y * per_length};
  }
  static Interval angle_of(const Interval& x, const Interval& y) { return tubefoot::angle_of(x, y); }
  static Interval turn(const Interval& height, const Interval& s) { return tubefoot::angle_of(s, height); }
  static Interval incidence(const Interval& distance, const Interval& rho) {
    return tubefoot::angle_of(distance, rho);
  }
  static Interval rho_q2(const IntervalPolygon::Edge& edge, const FineInterval&) {
    return squared(edge.height);
  }
  static Interval range_product(const Interval& r2, const Interval&) { return r2; }
  static RangeEnclosure range_at(const Interval& distance, double incidence_rad) {
    const double cosine = std::cos(incidence_rad);
    const Interval range = distance / outwards(cosine, cosine, library_units);
    return {range.lo, range.hi};
  }
};

/// Balls. Functions of N are also for ComplexBall, which bounds the integrand about an interval.
struct BallNumbers {
  using Fine = Ball;
  using Number = Ball;
  static constexpr bool constants_apart = false;

  static const Ball& number(const Ball& x) { return x; }
  static RangeEnclosure enclosure(const Ball& x) { return {x.fine_lo(), x.fine_hi()}; }
  static double upper(const Ball& x) { return x.hi(); }
  static Ball pi() { return Ball::pi(); }
  static Ball two_pi() { return Ball(2) * Ball::pi(); }
  static bool is_direction(const Ball& angle) { return angle.is_finite(); }

  static std::array<Ball, 2> direction(const Ball& x, const Ball& y, const Ball& length) {
    return {x / length, y / length};
  }
  /// The result for a ball around pi stays in one piece; it is not split into pi and -pi.
  static Ball angle_of(const Ball& x, const Ball& y) {
    if (x.surely_negative()) return Ball::pi() + atan2(-y, -x);
    return atan2(y, x);
  }
  /// atan(height / s) for s > 0, by the formula that is not near a pole.
  template <class N>
  static N turn(const Ball& height, const N& s) {
    if (std::abs(height.middle()) <= size_of(s) || height.may_be_zero()) return atan(N(height) / s);
    const N quarter = N(Ball::pi() / Ball(height.surely_positive() ? 2 : -2));
    return quarter - atan(s / N(height));
  }
  template <class N>
  static N incidence(const Ball& distance, const N& rho) {
    return N(Ball::pi() / Ball(2)) - turn(distance, rho);
  }
  template <class Edge>
  static Ball rho_q2(const Edge& edge, const Ball& distance2) {
    return edge.nearest2 - distance2;
  }
  template <class N>
  static N range_product(const N&, const N& r) {
    return squared(r);
  }
  static RangeEnclosure range_at(const Ball& distance, double incidence_rad) {
    Ball sine, cosine;
    sin_cos(Ball(incidence_rad), sine, cosine);
    return enclosure(distance / cosine);
  }

 private:
  static double size_of(const Ball& x) { return std::abs(x.middle()); }
  static double size_of(const ComplexBall& x) { return std::abs(x.real().middle()); }
};

/// Dual numbers, and doubles as Dual<0>. Ranges have no width.
template <std::size_t n>
struct DualNumbers {
  using Fine = Dual<n>;
  using Number = Dual<n>;
  static constexpr bool constants_apart = true;

  static const Number& number(const Number& x) { return x; }
  static RangeEnclosure enclosure(const Number& x) { return {x.value, x.value}; }
  static Number pi() { return std::numbers::pi; }
  static Number two_pi() { return 2 * std::numbers::pi; }
  static bool is_direction(const Number& angle) { return angle.is_finite(); }

  static std::array<Number, 2> direction(const Number& x, const Number& y, const Number& length) {
    return {x / length, y / length};
  }
  static Number angle_of(const Number& x, const Number& y) { return atan2(y, x); }
  static Number turn(const Number& height, const Number& s) { return atan2(height, s); }
  static Number incidence(const Number& distance, const Number& rho) { return atan2(rho, distance); }
  template <class Edge>
  static Number rho_q2(const Edge& edge, const Number&) {
    return squared(edge.height);
  }
  static Number range_product(const Number& r2, const Number&) { return r2; }
  static RangeEnclosure range_at(const Number& distance, double incidence_rad) {
    return enclosure(distance / Number(std::cos(incidence_rad)));
  }
};

}  // namespace tubefoot
