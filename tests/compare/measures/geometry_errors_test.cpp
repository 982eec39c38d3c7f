// SPDX-License-Identifier: GPL-3.0-or-later
// Tests noise floors, averaged frames, and geometry errors: first returns and masks, which do not depend on
// the unit of energy.
#include "compare/measures/geometry_errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::Optional;

TEST(DeepShadow, KeepsItsDistanceFromEchoes) {
  std::vector<double> energy(3 * 7, 0.0);
  energy[1 * 7 + 3] = 1;
  const auto shadow = deep_shadow({1, 3, 7}, energy, 1, 2);
  for (std::size_t beam = 0; beam < 3; ++beam)
    for (std::size_t sample = 0; sample < 7; ++sample)
      EXPECT_EQ(shadow[beam * 7 + sample], sample < 1 || sample > 5) << beam << " " << sample;
  EXPECT_TRUE(deep_shadow({1, 3, 7}, energy, 0, 0)[3]) << "another beam";
  EXPECT_TRUE(deep_shadow({3, 1, 7}, energy, 1, 0)[3]) << "another ping";
}

/// Energies of 2 behind 20 dark samples and before 20 others, in 40 beams of 60 samples.
struct Step {
  EchoShape shape{1, 40, 60};
  std::vector<double> reference, candidate, ranges;
  Step() {
    for (std::size_t b = 0; b < 40; ++b)
      for (std::size_t s = 0; s < 60; ++s) reference.push_back(s >= 20 && s < 40 ? 2 : 0);
    candidate = reference;
    for (std::size_t s = 0; s < 60; ++s) ranges.push_back(1 + double(s));
  }
  void add_noise(double deviation, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, deviation);
    for (double& e : candidate) e = std::max(0.0, e + noise(random));
  }
  GeometryErrors errors() const { return geometry_errors({shape, reference, candidate, {}, ranges}); }
};

TEST(NoiseFloor, OfNoiseClippedAtZero) {
  Step step;
  step.add_noise(0.1, 1);
  const NoiseFloor floor = step.errors().floor;
  // Half of a normal distribution: mean sigma / sqrt(2 pi), mean square sigma^2 / 2.
  const double mean = 0.1 / std::sqrt(2 * M_PI), deviation = 0.1 * std::sqrt(0.5 - 0.5 / M_PI);
  EXPECT_NEAR(floor.mean_j, mean, 4 * floor.mean_error_j);
  EXPECT_NEAR(floor.mean_error_j, deviation / std::sqrt(double(floor.bins)), 0.4 * floor.mean_error_j);
  EXPECT_NEAR(floor.deviation_j, deviation, 0.05 * deviation);
  EXPECT_NEAR(floor.share_positive, 0.5, 0.05);
  EXPECT_EQ(floor.bins, 40u * (17 + 17));
}

TEST(NoiseFloor, AnObjectWithoutShadowIsNoNoise) {
  Step step;
  step.add_noise(0.1, 1);
  const double before = step.errors().floor.mean_j;
  for (std::size_t b = 10; b < 20; ++b)
    for (std::size_t s = 45; s < 55; ++s) step.candidate[b * 60 + s] += 2;
  EXPECT_NEAR(step.errors().floor.mean_j, before, 0.1 * before);
  EXPECT_EQ(step.errors().floor.bins, 40u * 34 - 100);
}

TEST(GeometryErrors, OneNoisyBinIsNoFirstReturn) {
  Step step;
  step.add_noise(0.01, 2);
  step.candidate[5 * 60 + 2] = 7;  // far above all others
  const GeometryErrors errors = step.errors();
  EXPECT_EQ(errors.first_return.in_both, 40u);
  EXPECT_EQ(errors.first_return.mean_absolute_samples, 0);
  EXPECT_THAT(steady_first_returns(step.shape, step.candidate, 1, true)[5], Optional(2u));
  EXPECT_THAT(steady_first_returns({1, 1, 6}, std::vector<double>{5, 0, 0, 5, 0, 5}, 1, false),
              ElementsAre(Optional(3u)));
}

TEST(GeometryErrors, MasksOverlapAsFarAsTheyDo) {
  Step step;
  for (std::size_t b = 0; b < 40; ++b)
    std::rotate(&step.candidate[b * 60], &step.candidate[b * 60 + 55], &step.candidate[b * 60] + 60);
  const GeometryErrors errors = step.errors();  // five samples later: lit 25 to 44
  EXPECT_EQ(errors.visible.reference, 800u);
  EXPECT_EQ(errors.visible.candidate, 800u);
  EXPECT_DOUBLE_EQ(errors.visible.iou(), 15.0 / 25);
  EXPECT_DOUBLE_EQ(errors.shadow.iou(), 20.0 / 25) << "before the last echo of each beam";
  EXPECT_DOUBLE_EQ(errors.first_return.mean_m, 5);
}

TEST(GeometryErrors, UnitsDoNotMatterAndAThresholdCanBeGiven) {
  Step step;
  for (double& e : step.candidate) e *= 1e9;
  EXPECT_EQ(step.errors().visible.iou(), 1);
  const EchoPair pair{step.shape, step.reference, step.candidate, {}, step.ranges};
  EXPECT_EQ(geometry_errors(pair, 3e9).visible.candidate, 0u);
}

TEST(Frames, AreAveragedInOrder) {
  const std::vector<double> energy{1, 2, 3, 4, 10, 20, 30, 40};
  EXPECT_THAT(mean_of_frames({4, 1, 2}, energy, 2), ElementsAre(2, 3, 20, 30));
  EXPECT_THROW(mean_of_frames({4, 1, 2}, energy, 3), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
