// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/relief/portable_random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tubefoot {
namespace {

TEST(PortableRandom, LogarithmAndExponentialAreTheLibrarysToAnUlpOrTwo) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-300, 300), power(-600, 600);
  for (int n = 0; n < 100000; ++n) {
    const double x = std::exp2(exponent(random)), y = n % 2 == 0 ? power(random) : power(random) / 600;
    const long double log = std::log(static_cast<long double>(x)),
                      exp = std::exp(static_cast<long double>(y));
    ASSERT_NEAR(static_cast<double>(portable_log(x) / log), 1, 6e-16) << x;
    ASSERT_NEAR(static_cast<double>(portable_exp(y) / exp), 1, 6e-16) << y;
  }
  EXPECT_EQ(portable_log(1), 0);
  EXPECT_EQ(portable_exp(0), 1);
}

TEST(PortableRandom, PairsAreNormalAndIndependentOfTheirNeighbours) {
  constexpr int side = 300;
  double sum = 0, squares = 0, fourths = 0, cross = 0, neighbours = 0, streams = 0, seeds = 0;
  for (int i = -side / 2; i < side / 2; ++i)
    for (int j = -side / 2; j < side / 2; ++j) {
      const auto [a, b] = normal_pair(7, 1, i, j);
      sum += a + b;
      squares += a * a + b * b;
      fourths += a * a * a * a + b * b * b * b;
      cross += a * b;
      neighbours += a * normal_pair(7, 1, i + 1, j)[0] + a * normal_pair(7, 1, j, i)[1];
      streams += a * normal_pair(7, 2, i, j)[0];
      seeds += a * normal_pair(8, 1, i, j)[0];
    }
  const double count = side * side, sigma = 1 / std::sqrt(count);
  EXPECT_NEAR(sum / (2 * count), 0, 4 * sigma);
  EXPECT_NEAR(squares / (2 * count), 1, 4 * sigma);
  EXPECT_NEAR(fourths / (2 * count), 3, 4 * std::sqrt(96.0 / 2) * sigma);
  for (const double correlation : {cross, neighbours / 2, streams, seeds})
    EXPECT_NEAR(correlation / count, 0, 5 * sigma);
  EXPECT_EQ(normal_pair(7, 1, -3, 5), normal_pair(7, 1, -3, 5));
}

}  // namespace
}  // namespace tubefoot
