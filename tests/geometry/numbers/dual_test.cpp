// SPDX-License-Identifier: GPL-3.0-or-later
// Tests dual numbers: every operation against the derivative of its function in closed form.
#include "geometry/numbers/dual.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace tubefoot {
namespace {

using Dual2 = Dual<2>;

/// Compares a dual number with a value and its two partial derivatives.
void expect(const Dual2& x, double value, double by_a, double by_b) {
  EXPECT_DOUBLE_EQ(x.value, value);
  EXPECT_DOUBLE_EQ(x.derivative[0], by_a);
  EXPECT_DOUBLE_EQ(x.derivative[1], by_b);
}

TEST(Dual, CarriesPartialDerivativesThroughEveryOperation) {
  const double a = 1.7, b = 0.6;
  const Dual2 x = Dual2::parameter(a, 0), y = Dual2::parameter(b, 1);
  expect(x + y, a + b, 1, 1);
  expect(x - y, a - b, 1, -1);
  expect(-x, -a, -1, 0);
  expect(x * y, a * b, b, a);
  expect(x / y, a / b, 1 / b, -a / (b * b));
  expect(3 * x * x, 3 * a * a, 6 * a, 0);
  expect(squared(x), a * a, 2 * a, 0);
  expect(root(x), std::sqrt(a), 0.5 / std::sqrt(a), 0);
  expect(exp(x * y), std::exp(a * b), b * std::exp(a * b), a * std::exp(a * b));
  expect(power_of(x, 2.5), std::pow(a, 2.5), 2.5 * std::pow(a, 1.5), 0);
  expect(atan2(y, x), std::atan2(b, a), -b / (a * a + b * b), a / (a * a + b * b));
}

TEST(Dual, RootOfZeroIsConstant) { expect(root(Dual2::parameter(0, 0)), 0, 0, 0); }

}  // namespace
}  // namespace tubefoot
