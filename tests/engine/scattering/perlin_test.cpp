// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/perlin.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tubefoot {
namespace {

TEST(Perlin, ReferencePermutationGivesThePublishedValues) {
  const PerlinLattice noise;
  EXPECT_DOUBLE_EQ(noise(3.14, 42, 7), 0.13691995878400012);
  EXPECT_DOUBLE_EQ(noise(-4.20, 10, 6), 0.14208000000000043);
  EXPECT_DOUBLE_EQ(noise(.5, .5, .5), -0.25);
  EXPECT_DOUBLE_EQ(noise(1.5, 2.5, 3.5), 0.125);
  EXPECT_DOUBLE_EQ(noise(.1, .2, .3), 0.35122924878110723);
  EXPECT_DOUBLE_EQ(noise(-1.3, .7, 12.9), 0.27080538446499863);
  EXPECT_DOUBLE_EQ(noise(255.5, 255.5, 255.5), -0.875);
}

TEST(Perlin, IsNothingAtTheLatticeAndSmoothAcrossIt) {
  const PerlinLattice noise(7);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> at(0, 1);
  std::uniform_int_distribution<int> cell(-300, 300);
  for (int trial = 0; trial < 1000; ++trial) {
    const double i = cell(random), j = cell(random), k = cell(random);
    EXPECT_EQ(noise(i, j, k), 0);
    const double y = j + at(random), z = k + at(random), h = 1e-4;
    const double below = noise(i - h, y, z), on = noise(i, y, z), above = noise(i + h, y, z);
    // The second derivative is continuous, so that the second difference is of second order.
    EXPECT_NEAR(above - 2 * on + below, 0, 1e-6);
    EXPECT_NEAR(above, below, 10 * h);
  }
}

TEST(Perlin, HasTheSheetsStatistics) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> at(0, 256);
  for (const std::uint64_t seed : {0u, 1u, 99u}) {
    const PerlinLattice noise(seed);
    double sum = 0, squares = 0, largest = 0;
    constexpr int points = 400000;
    for (int p = 0; p < points; ++p) {
      const double n = noise(at(random), at(random), at(random));
      sum += n;
      squares += n * n;
      largest = std::max(largest, std::abs(n));
    }
    EXPECT_NEAR(sum / points, 0, 0.005) << seed;
    EXPECT_NEAR(std::sqrt(squares / points), 0.27004, 0.005) << seed;
    EXPECT_LE(largest, PerlinLattice::largest) << seed;
    EXPECT_GT(largest, 0.8) << seed;
  }
}

TEST(Perlin, SeedsAreDifferentNoises) {
  const PerlinLattice one(1), two(2), one_again(1);
  EXPECT_NE(one(0.3, 0.4, 0.5), two(0.3, 0.4, 0.5));
  EXPECT_EQ(one(0.3, 0.4, 0.5), one_again(0.3, 0.4, 0.5));
}

}  // namespace
}  // namespace tubefoot
