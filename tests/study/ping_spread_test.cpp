// SPDX-License-Identifier: GPL-3.0-or-later
// Compares confidence limits of the errors of pings with samples of known distribution.
#include "study/ping_spread.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace tubefoot {
namespace {

TEST(ErrorLimit, AlikePingsGetTheLeastMarginAndNoErrorGetsNone) {
  const std::vector<PingError> alike(4, PingError{0.02, 1, 4 * 100, 100});
  EXPECT_DOUBLE_EQ(error_limit(alike, 100, ErrorMeasure::l1), 0.02 * least_margin);
  EXPECT_DOUBLE_EQ(error_limit(alike, 100, ErrorMeasure::rms_db), 2 * least_margin);
  const std::vector<PingError> exact(1, PingError{0, 1, 0, 100});
  EXPECT_EQ(error_limit(exact, 100, ErrorMeasure::l1), 0);
}

// Two pings of equal energy with errors of 1 and 3: mean 2, standard error 1, Student's t of one degree
// 6.3138.
TEST(ErrorLimit, IsStudentsLimitAndOnePingOfManyTellsNothing) {
  const std::vector<PingError> two{{0.01, 1, 0, 1}, {0.03, 1, 0, 1}};
  EXPECT_NEAR(error_limit(two, 1'000'000'000, ErrorMeasure::l1), 0.02 + 6.3138 * 0.01, 1e-6);
  EXPECT_NEAR(error_limit(two, 4, ErrorMeasure::l1), 0.02 + 6.3138 * 0.01 * std::sqrt(2.0), 1e-6);
  EXPECT_DOUBLE_EQ(error_limit(two, 2, ErrorMeasure::l1), 0.02 * least_margin);
  EXPECT_TRUE(std::isinf(error_limit(std::span(two).first(1), 2, ErrorMeasure::l1)));
}

TEST(ErrorLimit, HoldsTheMeanAsOftenAsItSays) {
  const unsigned seed = 5;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::normal_distribution<double> error(1, 0.4);
  int held = 0;
  constexpr int draws = 4000;
  for (int k = 0; k < draws; ++k) {
    std::vector<PingError> pings;
    for (int p = 0; p < 6; ++p) pings.push_back({error(random), 1, 0, 1});
    held += error_limit(pings, 1'000'000, ErrorMeasure::l1) >= 1;
  }
  EXPECT_NEAR(static_cast<double>(held) / draws, error_limit_confidence, 0.015);
}

}  // namespace
}  // namespace tubefoot
