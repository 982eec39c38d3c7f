// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

// Dual numbers: values that carry their derivatives by n parameters through every operation (forward-mode
// differentiation; A. Griewank and A. Walther, Evaluating Derivatives, chapter 3). Decisions depend on the
// value alone. The type of Boost.Math (differentiation/autodiff.hpp) is nested for each parameter and also
// computes mixed derivatives, so its cost doubles with each parameter. Here the cost is proportional to n.
namespace tubefoot {

/// With n = 0 a dual number is a double.
template <std::size_t n>
struct Dual {
  double value = 0;
  std::array<double, n> derivative{};

  Dual() = default;
  Dual(double constant) : value(constant) {}  // NOLINT: exact, so as good as the number itself
  explicit Dual(long double constant) : value(static_cast<double>(constant)) {}
  /// The parameter `which` itself, at this value.
  static Dual parameter(double value, std::size_t which) {
    Dual x(value);
    x.derivative.at(which) = 1;
    return x;
  }

  double middle() const { return value; }
  bool is_finite() const { return std::isfinite(value); }
  bool surely_positive() const { return value > 0; }
  bool surely_negative() const { return value < 0; }

  /// Returns a function of this number, from the value and the slope of the function.
  Dual through(double function, double slope) const {
    Dual result(function);
    for (std::size_t i = 0; i < n; ++i) result.derivative[i] = slope * derivative[i];
    return result;
  }

  Dual operator-() const { return through(-value, -1); }
  friend Dual operator+(const Dual& a, const Dual& b) { return combined(a.value + b.value, a, 1, b, 1); }
  friend Dual operator-(const Dual& a, const Dual& b) { return combined(a.value - b.value, a, 1, b, -1); }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return combined(a.value * b.value, a, b.value, b, a.value);
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const double quotient = a.value / b.value;
    return combined(quotient, a, 1 / b.value, b, -quotient / b.value);
  }
  Dual& operator+=(const Dual& b) { return *this = *this + b; }

  friend Dual squared(const Dual& x) { return x * x; }
  /// Returns the square root of a number that is known not to be negative. The root of 0 has no
  /// derivative, and the result is the constant 0.
  friend Dual root(const Dual& x) {
    if (!(x.value > 0)) return {};
    const double root = std::sqrt(x.value);
    return x.through(root, 0.5 / root);
  }
  friend Dual exp(const Dual& x) {
    const double power = std::exp(x.value);
    return x.through(power, power);
  }
  /// x > 0, unless the exponent is 0.
  friend Dual power_of(const Dual& x, double exponent) {
    if (exponent == 0) return 1;
    const double power = std::pow(x.value, exponent);
    return x.through(power, exponent * power / x.value);
  }
  friend Dual atan2(const Dual& y, const Dual& x) {
    const double square = y.value * y.value + x.value * x.value;
    return combined(std::atan2(y.value, x.value), y, x.value / square, x, -y.value / square);
  }

 private:
  static Dual combined(double function, const Dual& a, double by_a, const Dual& b, double by_b) {
    Dual result(function);
    for (std::size_t i = 0; i < n; ++i)
      result.derivative[i] = by_a * a.derivative[i] + by_b * b.derivative[i];
    return result;
  }
};

}  // namespace tubefoot
