// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/knife_edge.hpp"

#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

// Evaluates Fresnel integrals by their power series near 0, and elsewhere by the continued fraction of the
// complementary error function. The intensity in deep shadow is not a difference of large numbers.

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

/// C(x) + i S(x) for 0 <= x <= 1.5: the series of the integral of exp(i pi t^2 / 2).
Complex fresnel_series(double x) {
  const Complex step(0, std::numbers::pi / 2 * x * x);
  Complex power = x, sum = x;
  for (int k = 1; std::abs(power) > std::numeric_limits<double>::epsilon() * std::abs(sum) / 8; ++k) {
    power *= step / double(k);
    sum += power / double(2 * k + 1);
  }
  return sum;
}

/// (1/2 - C(x)) + i (1/2 - S(x)) for x >= 1.5. This is (1 + i) / 2 erfc(sqrt(pi) / 2 (1 - i) x). The even
/// part of the continued fraction of erfc (Abramowitz and Stegun 7.1.14) is evaluated with Lentz's method.
Complex fresnel_complement(double x) {
  constexpr double tiny = 1e-300;
  const double square = std::numbers::pi * x * x;
  Complex b(1, -square), c = 1 / tiny, d = 1.0 / b, fraction = d;
  for (int n = 1; n < 2000; n += 2) {
    const double a = -double(n) * (n + 1);
    b += 4.0;
    d = 1.0 / (a * d + b);
    c = b + a / c;
    const Complex change = c * d;
    fraction *= change;
    if (std::abs(change - 1.0) < std::numeric_limits<double>::epsilon()) break;
  }
  // (1 + i) / 2 (1 - i) = 1.
  return x * std::polar(1.0, square / 2) * fraction;
}

Complex fresnel_remainder(double nu) {
  constexpr double series_to = 1.5;
  const double x = std::abs(nu);
  const Complex remainder = x < series_to ? Complex(0.5, 0.5) - fresnel_series(x) : fresnel_complement(x);
  return nu >= 0 ? remainder : Complex(1, 1) - remainder;
}

/// Cubic Hermite interpolation of the intensity. The interpolation error is below h^4 / 384 times the
/// fourth derivative, which is below 1e5.
class IntensityTable {
 public:
  IntensityTable() {
    for (int k = 0; k <= cells; ++k) {
      const double nu = first + k * step;
      const Complex remainder = fresnel_remainder(nu);
      const double intensity = std::norm(remainder) / 2, phase = std::numbers::pi / 2 * nu * nu,
                   slope = -remainder.real() * std::cos(phase) - remainder.imag() * std::sin(phase);
      node_[std::size_t(k)] = {intensity, slope * step};
    }
  }
  double at(double nu) const {
    const double place = (nu - first) / step, cell = std::floor(place), t = place - cell;
    const Node &a = node_[std::size_t(cell)], &b = node_[std::size_t(cell) + 1];
    const double difference = b.value - a.value;
    return a.value + t * (a.slope + t * (3 * difference - 2 * a.slope - b.slope +
                                         t * (a.slope + b.slope - 2 * difference)));
  }

 private:
  static constexpr double first = -4.5, last = 4.25, step = 1.0 / 256;
  static constexpr int cells = int((last - first) / step);
  struct Node {
    double value, slope;
  };
  std::array<Node, cells + 1> node_;
};

}  // namespace

double knife_edge_intensity(double nu) { return std::norm(fresnel_remainder(nu)) / 2; }

double truncated_knife_edge_intensity(double nu) {
  static const IntensityTable table;
  if (nu < knife_edge_lit_limit) return 1;
  if (nu > knife_edge_shadow_limit) return 0;
  return table.at(nu);
}

}  // namespace tubefoot
