// SPDX-License-Identifier: GPL-3.0-or-later
// Tests zero crossings of split-beam phases: exact lines, the effect of noise on the crossing, and phases
// that do not form a line.
#include "sensors/detection/split_beam.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "fixtures/refusal.hpp"

namespace tubefoot {
namespace {

using Complex = std::complex<double>;

/// Phase slope (k - zero), random moduli, and noise with this standard deviation for a modulus of 1.
std::vector<Complex> line(double zero, double slope_rad, double noise_rad, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Complex> product;
  for (int k = 0; k < 200; ++k) {
    const double modulus = 0.2 + 3 * double(random() % 1000) / 1000;
    product.push_back(
        std::polar(modulus, slope_rad * (k - zero) + noise_rad * normal(random) / std::sqrt(modulus)));
  }
  return product;
}

TEST(SplitBeam, FindsTheZeroOfALineToTheLastBits) {
  for (const double slope : {0.05, -0.12, 0.6})
    for (const double from : {90.0, 101.5, 108.0}) {
      if (std::abs(slope * (from - 101.37)) > 3) continue;  // another zero is nearer
      const auto found = split_beam_zero(line(101.37, slope, 0), {from, 25, 1.4, 0, 1});
      ASSERT_TRUE(found);
      EXPECT_NEAR(found->sample, 101.37, 1e-9);
      EXPECT_NEAR(found->slope_rad, slope, 1e-10);
      EXPECT_LT(found->sigma, 1e-9);
      EXPECT_LE(found->samples, 51u);
      EXPECT_LE(found->samples, std::size_t(2 * 1.4 / std::abs(slope) + 1));
    }
}

TEST(SplitBeam, KnowsItsOwnError) {
  double squares = 0, said = 0;
  constexpr int draws = 2000;
  for (int draw = 0; draw < draws; ++draw) {
    const auto found = split_beam_zero(line(101.37, 0.08, 0.3, 100u + unsigned(draw)), {100, 15, 1.4, 0, 1});
    ASSERT_TRUE(found);
    squares += std::pow(found->sample - 101.37, 2);
    said += found->sigma * found->sigma;
  }
  EXPECT_NEAR(squares / said, 1, 0.1);  // a standard deviation of 2000 squares: 3 %
  EXPECT_GT(squares / draws, 0.1);
  // A fourfold sampling rate gives no more information: repeated values give the same positions and the
  // same error.
  const std::vector<Complex> once = line(50.2, 0.08, 0.3);
  std::vector<Complex> held;
  for (std::size_t k = 0; k < 4 * once.size(); ++k) held.push_back(once[k / 4]);
  const auto slow = split_beam_zero(once, {50, 15, 1.4, 0, 1}),
             fast = split_beam_zero(held, {201.5, 60, 1.4, 0, 4});
  ASSERT_TRUE(slow && fast);
  EXPECT_NEAR((fast->sample - 1.5) / 4, slow->sample, 0.3 * slow->sigma);
  EXPECT_NEAR(fast->sigma / 4, slow->sigma, 0.1 * slow->sigma);
}

TEST(SplitBeam, FollowsTheBowOfALevelSeabed) {
  // A seabed 10 m below at 60 degrees: phases of sines relative to the one at 20 m.
  constexpr double step_m = 0.02, range_m = 20.0045, turn_rad = 80;
  std::vector<Complex> product;
  const auto sine = [](double r) { return std::sqrt(1 - 100 / (r * r)); };
  for (int k = 0; k < 200; ++k)
    product.push_back(std::polar(1.0, turn_rad * (sine(18 + k * step_m) - sine(range_m))));
  SplitBeamSearch search{100, 60, 1.4, 0, 1};
  const double truth = (range_m - 18) / step_m;
  const auto straight = split_beam_zero(product, search);
  search.bend = level_seabed_bend(20, std::sqrt(0.75), step_m);
  const auto refracted = split_beam_zero(product, search);
  ASSERT_TRUE(straight && refracted);
  EXPECT_GT(std::abs(straight->sample - truth), 1);
  EXPECT_LT(std::abs(refracted->sample - truth), 0.05);
}

TEST(SplitBeam, FindsNothingWhereThereIsNoLine) {
  EXPECT_FALSE(split_beam_zero({}, {0, 10, 1, 0, 1}));
  EXPECT_FALSE(split_beam_zero(std::vector<Complex>(200), {100, 10, 1, 0, 1}));
  // For a point beside the axis the phase is the same in all samples.
  EXPECT_FALSE(split_beam_zero(std::vector<Complex>(200, std::polar(1.0, 0.4)), {100, 10, 1, 0, 1}));
  EXPECT_FALSE(split_beam_zero(line(100, 1e-3, 0), {100, 10, 1, 0, 1}));    // turns by 0.02
  EXPECT_FALSE(split_beam_zero(line(140, 0.05, 0), {100, 20, 1.4, 0, 1}));  // beyond the window
  EXPECT_FALSE(split_beam_zero(line(100, 0.8, 0), {100, 20, 1, 0, 1}));     // two samples in the lobe
  EXPECT_FALSE(split_beam_zero(line(100, 0.05, 0), {100, 20, 1, 0, 12}));   // three looks
  EXPECT_TRUE(split_beam_zero(line(100, 0.05, 0), {100, 20, 1, 0, 8}));
  EXPECT_FALSE(split_beam_zero(line(100, 0.05, 0), {900, 20, 1, 0, 1}));
  expect_refused([] { split_beam_zero(line(0, 1, 0), {1, 1, 4, 0, 1}); }, "between phases of 0 and pi");
  expect_refused([] { split_beam_zero(line(0, 1, 0), {1, -1, 1, 0, 1}); }, "0 or more samples");
}

}  // namespace
}  // namespace tubefoot
