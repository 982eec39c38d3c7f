// SPDX-License-Identifier: GPL-3.0-or-later
// Tests bottom detection by centroid, first return and maximum: ranges, sigmas, quality, flags and gates,
// on synthetic beams and a flat Lambert seabed.

#include "sensors/detection/bottom_detection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <span>

#include "fixtures/statistics.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/receiver/receiver.hpp"

namespace tubefoot {
namespace {

constexpr RangeSamples samples{10, 0.05, 400};
const double anywhere = 0.05 / std::sqrt(12.0);

constexpr DetectionMethod methods[] = {DetectionMethod::first_return, DetectionMethod::energy_centroid,
                                       DetectionMethod::maximum};

double middle(const RangeSamples& of, int k) { return of.first_m + (k + 0.5) * of.step_m; }

/// Energies of a beam from `least` to `most` off the vertical, over a flat Lambert seabed `height` below.
/// In a fan of azimuth dphi the part from R1 to R2 returns (mu height^2 dphi / 4) (R1^-4 - R2^-4).
std::vector<double> flat_seabed(double height, double least, double most, const RangeSamples& of) {
  const double near = height / std::cos(least), far = height / std::cos(most);
  const double scale = 2e-3 * height * height * 1.5 * degree / 4;
  std::vector<double> energies;
  for (int k = 0; k < of.count; ++k) {
    const double from = std::max(near, of.first_m + k * of.step_m),
                 to = std::min(far, of.first_m + (k + 1) * of.step_m);
    energies.push_back(from < to ? scale * (std::pow(from, -4) - std::pow(to, -4)) : 0);
  }
  return energies;
}

TEST(BottomDetection, CentroidOfASymmetricFootprintIsTheBeamsAxis) {
  for (const double axis : {middle(samples, 200), middle(samples, 123) + 0.025}) {  // middle and border
    std::vector<double> energies;
    for (int k = 0; k < samples.count; ++k)
      energies.push_back(1e-9 * std::exp(-std::pow((middle(samples, k) - axis) / 0.4, 2)));
    const auto found = detect_bottom(energies, samples);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->range_m, axis, 1e-12);
    EXPECT_NEAR(detect_bottom(energies, samples, {DetectionMethod::maximum})->range_m, axis, 1e-12);
  }
}

TEST(BottomDetection, CentroidOfTwoSamplesIsTheirLever) {
  std::vector<double> energies(400, 0.0);
  energies[100] = 3e-12;
  energies[101] = 1e-12;
  const auto found = detect_bottom(energies, samples);
  EXPECT_NEAR(found->range_m, middle(samples, 100) + 0.05 / 4, 1e-12);
  EXPECT_EQ(found->sample, 100);
  EXPECT_EQ(found->energy_j, 3e-12);
  EXPECT_TRUE(found->flags.empty());
  // w = 3/4, 1/4; distances 1/4 and 3/4 of a range bin of 0.05 m.
  EXPECT_NEAR(found->range_sigma_m,
              0.05 * std::sqrt(9.0 / 16 * (1.0 / 16 + 1.0 / 12) + 1.0 / 16 * (9.0 / 16 + 1.0 / 12)), 1e-12);
  // rms sqrt(3/4 / 16 + 1/4 9/16) of 400 range bins.
  EXPECT_NEAR(found->quality, 1 - std::sqrt(3.0 / 16) * std::sqrt(12.0) / 400, 1e-12);
}

// A sphere over the seabed: the mean range of both lies in the water between them.
TEST(BottomDetection, ACentroidIsOfOneEchoNotOfTheWaterBetweenTwo) {
  std::vector<double> energies(400, 0.0);
  for (int k = 100; k < 106; ++k) energies[k] = 4e-12;
  for (int k = 150; k < 170; ++k) energies[k] = 2e-12;
  auto found = detect_bottom(energies, samples);
  EXPECT_NEAR(found->range_m, middle(samples, 150) + 9.5 * 0.05, 1e-12);  // 40 against 24
  EXPECT_TRUE(found->flags.has(DetectionFlag::several_echoes));
  EXPECT_FALSE(found->flags.has(DetectionFlag::cut_by_window));
  for (int k = 150; k < 170; ++k) energies[k] = 1e-12;
  found = detect_bottom(energies, samples);
  EXPECT_NEAR(found->range_m, middle(samples, 100) + 2.5 * 0.05, 1e-12);
  EXPECT_TRUE(found->flags.has(DetectionFlag::several_echoes));
  for (int k = 150; k < 170; ++k) energies[k] = 0.1e-12;  // 2 of 24: below the threshold of a flag
  EXPECT_TRUE(detect_bottom(energies, samples)->flags.empty());
}

// A shadow of a few range bins within the footprint: the detection is one echo, in a bin with energy.
TEST(BottomDetection, ACentroidInAShadowMovesToTheNearestEnergy) {
  std::vector<double> energies(400, 0.0);
  for (int k = 200; k < 205; ++k) energies[k] = energies[k + 8] = 1e-12;  // 205 to 207 are dark
  auto found = detect_bottom(energies, samples);
  EXPECT_DOUBLE_EQ(found->range_m, middle(samples, 204));
  EXPECT_EQ(found->sample, 204);
  EXPECT_TRUE(found->flags.empty());
  energies[212] = 1.3e-12;  // the mean moves to the farther side of the gap
  found = detect_bottom(energies, samples);
  EXPECT_DOUBLE_EQ(found->range_m, middle(samples, 208));
  EXPECT_EQ(found->sample, 208);
}

TEST(BottomDetection, AnEchoAtTheWindowsEndIsFlagged) {
  for (const DetectionMethod method : methods) {
    SCOPED_TRACE(name_of(method));
    std::vector<double> energies(400, 0.0);
    for (int k = 380; k < 398; ++k) energies[k] = 1e-12;
    EXPECT_TRUE(detect_bottom(energies, samples, {method})->flags.empty());
    energies[394] = energies[395] = 0;  // energies fade, and may do so at the end of the range gate
    EXPECT_TRUE(detect_bottom(energies, samples, {method})->flags.has(DetectionFlag::cut_by_window));
    for (int k = 394; k < 400; ++k) energies[k] = k < 399 ? 1e-12 : 0;
    EXPECT_TRUE(detect_bottom(energies, samples, {method})->flags.has(DetectionFlag::cut_by_window));
    energies[399] = 1e-12;
    EXPECT_TRUE(detect_bottom(energies, samples, {method})->flags.has(DetectionFlag::cut_by_window));
    energies.assign(400, 0.0);
    for (int k = 0; k < 9; ++k) energies[k] = 1e-12;
    EXPECT_TRUE(detect_bottom(energies, samples, {method})->flags.has(DetectionFlag::cut_by_window));
    energies[0] = energies[1] = 0;
    EXPECT_TRUE(detect_bottom(energies, samples, {method})->flags.empty());
  }
  EXPECT_STREQ(name_of(DetectionFlags{}), "good");
}

// For any energies, the bin of a detection has energy and contains its range.
TEST(BottomDetection, LiesWhereEnergyIs) {
  constexpr unsigned seed = 20261123;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(0, 1);
  for (int run = 0; run < 3000; ++run) {
    std::vector<double> energies(400, 0.0);
    const double lit = std::pow(10, -3 * any(random));
    for (int k = 50; k < 350; ++k)
      if (any(random) < lit) energies[k] = -1e-12 * std::log(any(random));
    energies[50 + run % 300] = 1e-12;
    for (const DetectionMethod method : methods) {
      const auto found = detect_bottom(energies, samples, {method});
      ASSERT_TRUE(found);
      const double largest = *std::max_element(energies.begin(), energies.end());
      ASSERT_GE(energies[found->sample], 0.01 * largest * (1 - 1e-12)) << "run " << run;
      ASSERT_NEAR(found->range_m, middle(samples, found->sample), samples.step_m / 2 + 1e-12) << run;
      ASSERT_GE(found->energy_j, energies[found->sample]);
    }
  }
}

// A gate has the effect that nothing else was received, for any position of its borders and of the empty
// bins around echoes.
TEST(BottomDetection, AGateIsAWindowOfItsSamplesAlone) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> energy(0.1, 1);
  std::uniform_int_distribution<int> place(0, 399);
  int found = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::vector<double> energies(400, 0.0);
    for (int echo = 0; echo < 3; ++echo) {
      const int at = place(random);
      for (int k = at; k < std::min(400, at + trial % 23); ++k) energies[k] = energy(random);
    }
    const int a = place(random), b = place(random), first = std::min(a, b), last = std::max(a, b);
    const RangeSamples window{samples.first_m + first * samples.step_m, samples.step_m, last - first + 1};
    for (const DetectionMethod method : methods) {
      const DetectionRule rule{method, -20, 0, middle(samples, first) - 1e-3, middle(samples, last) + 1e-3};
      const auto gated = detect_bottom(energies, samples, rule);
      const auto alone = detect_bottom(
          std::span(energies).subspan(std::size_t(first), std::size_t(window.count)), window, {method});
      ASSERT_EQ(gated.has_value(), alone.has_value()) << trial;
      if (!gated) continue;
      ++found;
      EXPECT_EQ(gated->sample, first + alone->sample) << trial;
      EXPECT_NEAR(gated->range_m, alone->range_m, 1e-9);
      EXPECT_NEAR(gated->quality, alone->quality, 1e-9);
      EXPECT_EQ(gated->energy_j, alone->energy_j);
      EXPECT_EQ(gated->flags, alone->flags) << trial;
    }
  }
  EXPECT_GT(found, 300);
}

TEST(BottomDetection, FirstReturnIsTheFirstSampleOverBothThresholds) {
  std::vector<double> energies(400, 0.0);
  energies[50] = 1.001e-14;  // 40 dB below the maximum: a fish
  energies[80] = 1.001e-12;
  energies[81] = 1e-10;
  DetectionRule rule{DetectionMethod::first_return};
  EXPECT_EQ(detect_bottom(energies, samples, rule)->sample, 80);
  rule.relative_db = -40;
  EXPECT_EQ(detect_bottom(energies, samples, rule)->sample, 50);
  EXPECT_EQ(detect_bottom(energies, samples, rule)->energy_j, 1.001e-14);
  rule.absolute_j = 1.1e-14;
  EXPECT_EQ(detect_bottom(energies, samples, rule)->sample, 80);
  rule.relative_db = -19.9;
  const auto found = detect_bottom(energies, samples, rule);
  EXPECT_EQ(found->sample, 81);
  EXPECT_DOUBLE_EQ(found->range_m, middle(samples, 81));
  EXPECT_DOUBLE_EQ(found->range_sigma_m, anywhere);
  EXPECT_EQ(found->energy_j, 1e-10);
  rule.relative_db = -std::numeric_limits<double>::infinity();  // only the absolute threshold
  rule.absolute_j = 0;
  EXPECT_EQ(detect_bottom(energies, samples, rule)->sample, 50);
  rule.absolute_j = 1e-9;
  EXPECT_FALSE(detect_bottom(energies, samples, rule));
}

TEST(BottomDetection, MaximumIsTheTopOfTheParabola) {
  std::vector<double> energies(400, 0.0);
  const double top = middle(samples, 300) + 0.012;
  for (int k = 295; k <= 305; ++k) energies[k] = 1 - std::pow(middle(samples, k) - top, 2);
  const auto found = detect_bottom(energies, samples, {DetectionMethod::maximum});
  EXPECT_NEAR(found->range_m, top, 1e-10);
  EXPECT_EQ(found->energy_j, energies[300]);
  EXPECT_DOUBLE_EQ(found->range_sigma_m, anywhere);
}

TEST(BottomDetection, TiesGoToTheNearest) {
  std::vector<double> energies(400, 0.0);
  energies[30] = energies[90] = 5e-11;
  EXPECT_EQ(detect_bottom(energies, samples, {DetectionMethod::maximum})->sample, 30);
  EXPECT_DOUBLE_EQ(detect_bottom(energies, samples, {DetectionMethod::maximum})->range_m,
                   middle(samples, 30));
  EXPECT_EQ(detect_bottom(energies, samples)->sample, 30);  // two echoes: the nearer of equal ones
  energies[31] = 5e-11;                                     // two adjacent bins: their border
  EXPECT_NEAR(detect_bottom(energies, samples, {DetectionMethod::maximum})->range_m,
              middle(samples, 30) + 0.025, 1e-12);
  energies[32] = 5e-11;  // a plateau: still its near end, with the bin beside it
  EXPECT_NEAR(detect_bottom(energies, samples, {DetectionMethod::maximum})->range_m,
              middle(samples, 30) + 0.025, 1e-12);
  energies[29] = std::nextafter(5e-11, 0);  // almost a tie of three
  EXPECT_NEAR(detect_bottom(energies, samples, {DetectionMethod::maximum})->range_m,
              middle(samples, 30) + 0.025, 1e-12);
  energies.assign(400, 1e-10);  // all equal: no parabola, the first bin
  EXPECT_DOUBLE_EQ(detect_bottom(energies, samples, {DetectionMethod::maximum})->range_m, middle(samples, 0));
}

TEST(BottomDetection, NothingLitIsNoDetection) {
  for (const DetectionMethod method : methods) {
    EXPECT_FALSE(detect_bottom(std::vector<double>(400, 0.0), samples, {method}));
    EXPECT_FALSE(detect_bottom({}, {10, 0.05, 0}, {method}));
    std::vector<double> energies(400, 0.0);
    energies[399] = 1e-12;
    DetectionRule rule{method};
    rule.farthest_m = 29.97;  // the last middle lies at 29.975
    EXPECT_FALSE(detect_bottom(energies, samples, rule));
    rule.farthest_m = 29.976;
    EXPECT_EQ(detect_bottom(energies, samples, rule)->sample, 399);
    rule.nearest_m = 29.976;
    rule.farthest_m = 40;
    EXPECT_FALSE(detect_bottom(energies, samples, rule));
  }
}

TEST(BottomDetection, WhatLiesOutsideTheGateDoesNotCount) {
  const RangeSamples metres{0, 1, 10};
  const std::vector<double> energies{9, 8, 0, 3, 1, 2, 0, 7, 9, 0};
  for (const DetectionMethod method : methods) {
    DetectionRule rule{method};
    rule.nearest_m = rule.farthest_m = 3.5;  // exactly the middle of one bin
    const auto found = detect_bottom(energies, metres, rule);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->range_m, 3.5);
    EXPECT_EQ(found->energy_j, 3);
  }
  DetectionRule rule;
  rule.nearest_m = 2.5;
  rule.farthest_m = 6.5;
  const auto found = detect_bottom(energies, metres, rule);
  EXPECT_NEAR(found->range_m, (3 * 3.5 + 4.5 + 2 * 5.5) / 6, 1e-12);
  EXPECT_EQ(found->energy_j, 3);
}

TEST(BottomDetection, OneSampleIsFoundByAllAlike) {
  for (const int k : {0, 1, 399})
    for (const double energy : {1e-12, 5e-324, 1.7e308})
      for (const DetectionMethod method : methods) {
        std::vector<double> energies(400, 0.0);
        energies[k] = energy;
        const auto found = detect_bottom(energies, samples, {method});
        ASSERT_TRUE(found);
        EXPECT_DOUBLE_EQ(found->range_m, middle(samples, k));
        EXPECT_DOUBLE_EQ(found->range_sigma_m, anywhere);
        EXPECT_EQ(found->sample, k);
        EXPECT_EQ(found->energy_j, energy);
        EXPECT_EQ(found->quality, 1);
      }
}

TEST(BottomDetection, EnergiesOfAnyScaleGiveOneRange) {
  const auto energies = flat_seabed(12, 40 * degree, 43 * degree, samples);
  for (const DetectionMethod method : methods) {
    const auto found = detect_bottom(energies, samples, {method});
    for (const double scale : {0x1p-200, 0x1p900}) {
      std::vector<double> scaled;
      for (const double energy : energies) scaled.push_back(energy * scale);
      const auto again = detect_bottom(scaled, samples, {method});
      EXPECT_DOUBLE_EQ(again->range_m, found->range_m);
      EXPECT_DOUBLE_EQ(again->quality, found->quality);
    }
  }
}

TEST(BottomDetection, FlatSeabedUnderASeaBat8101) {
  // 101 beams of 1.5 degrees, 20 m above the seabed, cells of 1.25 cm.
  const double height = 20;
  const RangeSamples cells{18, 0.0125, 6000};
  for (int beam = 0; beam <= 100; ++beam) {
    SCOPED_TRACE(testing::Message() << "beam " << beam);
    const double angle = (-75 + 1.5 * beam) * degree, half = 0.75 * degree;
    const double least = std::max(0.0, std::abs(angle) - half), most = std::abs(angle) + half;
    const auto energies = flat_seabed(height, least, most, cells);
    const double near = height / std::cos(least), far = height / std::cos(most);
    const auto first = detect_bottom(energies, cells, {DetectionMethod::first_return});
    // The bin that contains the near edge of the footprint, or the next bin if this one has too little
    // energy.
    EXPECT_GE(first->range_m, near - cells.step_m / 2);
    EXPECT_LE(first->range_m, near + 1.5 * cells.step_m);
    // Mean of R over the weight R^-5.
    const double mean_range =
        4.0 / 3 * (std::pow(near, -3) - std::pow(far, -3)) / (std::pow(near, -4) - std::pow(far, -4));
    DetectionRule all{DetectionMethod::energy_centroid};
    all.relative_db = -std::numeric_limits<double>::infinity();
    const auto centroid = detect_bottom(energies, cells, all);
    EXPECT_NEAR(centroid->range_m, mean_range, cells.step_m / 2);
    EXPECT_GT(centroid->quality, 0.85);

    // Soundings of a rolled and turned sensor: only the pose places them on the seabed.
    const Pose pose{{100, -50, -3}, attitude_from_angles(0.7, 0, 0)};
    const glm::dvec3 axis{std::sin(angle), 0, -std::cos(angle)};
    const glm::dvec3 sounding = sounding_position(pose, axis, centroid->range_m);
    // The weight R^-5 moves the centroid towards the sonar, away from the axis, by at most this amount.
    const double axis_range = height / std::cos(angle), pull = (far - near) * (far - near) / near / 2;
    EXPECT_NEAR(centroid->range_m, axis_range, pull + cells.step_m);
    EXPECT_NEAR(sounding.z, -3 - height, (pull + cells.step_m) * std::cos(angle));
    const double across = centroid->range_m * std::sin(angle);
    EXPECT_NEAR(sounding.x, 100 + across * std::cos(0.7), 1e-9);  // starboard of a bow 0.7 east of north
    EXPECT_NEAR(sounding.y, -50 - across * std::sin(0.7), 1e-9);
  }
}

TEST(BottomDetection, FootprintsSeenBy8101AtTwentyMetresHaveTheirPublishedSizes) {
  const RangeSamples cells{18, 0.001, 60000};
  const auto edge = [](double range) { return std::sqrt(range * range - 400); };
  // At 60 degrees: 2.09559 m across. The first and last bins with energy give it to about a cell over sin
  // 60.
  auto energies = flat_seabed(20, 59.25 * degree, 60.75 * degree, cells);
  DetectionRule rule{DetectionMethod::first_return};
  rule.relative_db = -std::numeric_limits<double>::infinity();
  const double near = detect_bottom(energies, cells, rule)->range_m;
  std::reverse(energies.begin(), energies.end());
  const double far =
      2 * cells.first_m + cells.count * cells.step_m - detect_bottom(energies, cells, rule)->range_m;
  EXPECT_NEAR(edge(far) - edge(near), 2.09559, 0.0012);
  // Below the sonar: 0.52363 m, of which the range axis contains one half.
  energies = flat_seabed(20, 0, 0.75 * degree, {20, 1e-5, 1000});
  std::reverse(energies.begin(), energies.end());
  const double last = 20.01 - (detect_bottom(energies, {20, 1e-5, 1000}, rule)->range_m - 20);
  EXPECT_NEAR(2 * edge(last), 0.52363, 0.0005);
}

TEST(BottomDetection, CentroidSpreadsUnderSpeckleAsItsSigmaSays) {
  ReceiverDescription description;
  description.speckle.model = SpeckleModel::rayleigh;
  description.seed = 20261121;
  SCOPED_TRACE(testing::Message() << "seed " << description.seed);
  const ReceiverChain chain(description);
  const RangeSamples cells{18, 0.02, 1500};
  // about 90 cells with energy
  const auto energies = flat_seabed(20, 59.25 * degree, 60.75 * degree, cells);
  DetectionRule all{DetectionMethod::energy_centroid};
  all.relative_db = -std::numeric_limits<double>::infinity();
  const auto still = detect_bottom(energies, cells, all);
  std::vector<double> ranges;
  for (std::uint32_t ping = 0; ping < 2000; ++ping)
    ranges.push_back(detect_bottom(chain.receive(ping, energies, cells), cells, all)->range_m);
  EXPECT_NEAR(statistics::mean(ranges), still->range_m, 6 * still->range_sigma_m / std::sqrt(2000.0));
  // Two effects of a few per cent: 1/90 of the spread of the shares, and 1/sqrt(4000) of the estimate.
  EXPECT_NEAR(std::sqrt(statistics::variance(ranges)) / still->range_sigma_m, 1, 0.1);
}

TEST(BottomDetection, QualityIsNearNothingInNoise) {
  ReceiverDescription description;
  description.noise_level_db = 100;
  const ReceiverChain chain(description);
  const auto noise = chain.receive(0, std::vector<double>(400, 0.0), samples);
  for (const DetectionMethod method : methods)
    EXPECT_LT(detect_bottom(noise, samples, {method})->quality, 0.1);
}

std::string refusal(const std::vector<double>& energies, const RangeSamples& of, const DetectionRule& rule) {
  try {
    detect_bottom(energies, of, rule);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(BottomDetection, RefusesWhatIsNoBeamOrNoRule) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  using testing::HasSubstr;
  for (const double bad : {nan, inf, -1e-20}) {
    std::vector<double> energies(400, 1.0);
    energies[17] = bad;
    EXPECT_THAT(refusal(energies, samples, {}), HasSubstr("energy of sample 17"));
  }
  const std::vector<double> fine(400, 1.0);
  EXPECT_THAT(refusal(fine, {10, 0.05, 399}, {}), HasSubstr("400 energies, but 399 range samples"));
  EXPECT_THAT(refusal(fine, {10, 0, 400}, {}), HasSubstr("step 0 m"));
  EXPECT_THAT(refusal(fine, {nan, 1, 400}, {}), HasSubstr("first nan m"));
  const auto with = [&](auto change) {
    DetectionRule rule;
    change(rule);
    return refusal(fine, samples, rule);
  };
  EXPECT_THAT(with([](auto& rule) { rule.relative_db = 0.1; }), HasSubstr("relative threshold is 0.1"));
  EXPECT_THAT(with([&](auto& rule) { rule.relative_db = nan; }), HasSubstr("relative threshold is nan"));
  EXPECT_THAT(with([](auto& rule) { rule.absolute_j = -1; }), HasSubstr("absolute threshold is -1"));
  EXPECT_THAT(with([](auto& rule) { rule.nearest_m = 5, rule.farthest_m = 4; }), HasSubstr("gate is 5 to 4"));
  EXPECT_EQ(with([](auto&) {}), "accepted");
}

TEST(SoundingPosition, FollowsThePoseAndRefusesAnAxisThatIsNoDirection) {
  // Bow down by 90 degrees: forward looks down.
  const Pose down{{1, 2, 3}, attitude_from_angles(0, -90 * degree, 0)};
  const glm::dvec3 place = sounding_position(down, {0, 1, 0}, 7);
  EXPECT_NEAR(glm::distance(place, glm::dvec3(1, 2, -4)), 0, 1e-12);
  EXPECT_THROW(sounding_position(down, {0, 1.001, 0}, 7), std::invalid_argument);
  EXPECT_THROW(sounding_position(down, {0, 0, 0}, 7), std::invalid_argument);
  EXPECT_THROW(sounding_position(down, {0, std::nan(""), 0}, 7), std::invalid_argument);
  EXPECT_THROW(sounding_position(down, {0, 1, 0}, std::nan("")), std::invalid_argument);
  EXPECT_THROW(sounding_position(down, {0, 1, 0}, -1), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
