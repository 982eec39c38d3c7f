// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/water/sound_speed_profile.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tubefoot {
namespace {

TEST(SoundSpeedProfile, IsLinearBetweenItsPointsAndConstantBeyond) {
  const SoundSpeedProfile profile({{10, 1500}, {20, 1510}, {40, 1490}});
  EXPECT_EQ(profile.at(-5), 1500);
  EXPECT_EQ(profile.at(10), 1500);
  EXPECT_EQ(profile.at(13), 1503);
  EXPECT_EQ(profile.at(20), 1510);
  EXPECT_EQ(profile.at(30), 1500);
  EXPECT_EQ(profile.at(40), 1490);
  EXPECT_EQ(profile.at(1e6), 1490);
  EXPECT_EQ(profile.layers(), 4u);
  EXPECT_EQ(profile.layer_at(10), 1u);
  EXPECT_EQ(profile.layer_at(std::nextafter(10, 0)), 0u);
  EXPECT_EQ(profile.gradient_per_s(2), -1);
  EXPECT_EQ(profile.gradient_per_s(0), 0);
  EXPECT_EQ(profile.gradient_per_s(3), 0);
  EXPECT_FALSE(profile.is_constant());
  EXPECT_TRUE(SoundSpeedProfile(1480).is_constant());
  EXPECT_EQ(SoundSpeedProfile(1480).at(77), 1480);
}

TEST(SoundSpeedProfile, RefusesWhatIsNoProfile) {
  using Points = std::vector<ProfilePoint>;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Points& bad :
       {Points{}, Points{{0, 1500}, {0, 1501}}, Points{{5, 1500}, {0, 1501}}, Points{{0, 0}},
        Points{{0, -1500}}, Points{{0, nan}}, Points{{nan, 1500}}, Points{{0, 1500}, {INFINITY, 1500}}}) {
    EXPECT_THROW(SoundSpeedProfile{bad}, std::invalid_argument);
  }
}

TEST(SoundSpeedProfile, MunkAsPublished) {
  EXPECT_NEAR(munk_sound_speed_m_s(0), 1548.5210, 1e-4);
  EXPECT_NEAR(munk_sound_speed_m_s(1000), 1501.3816, 1e-4);
  EXPECT_EQ(munk_sound_speed_m_s(1300), 1500);
  EXPECT_NEAR(munk_sound_speed_m_s(5000), 1551.9107, 1e-4);
}

TEST(SoundSpeedProfile, SquareOfRefractiveIndexIsLinear) {
  const double c0 = 1550, g = 1.2;
  for (const double z : {0., 100., 1000.}) {
    const double n = c0 / n2_linear_sound_speed_m_s(z, c0, g);
    EXPECT_NEAR(n * n, 1 + 2 * g * z / c0, 1e-14);
  }
  EXPECT_NEAR((n2_linear_sound_speed_m_s(1e-3, c0, g) - c0) / 1e-3, -g, 1e-5);
  EXPECT_TRUE(std::isinf(n2_linear_sound_speed_m_s(-1e4, c0, g)));
}

TEST(SoundSpeedProfile, SamplesKeepTheStatedError) {
  const auto munk = [](double z) { return munk_sound_speed_m_s(z); };
  for (const double error : {1., 0.1, 0.001}) {
    const SoundSpeedProfile profile(sample_profile_within(munk, 0, 5000, error));
    double worst = 0;
    for (double z = 0; z <= 5000; z += 0.73) worst = std::max(worst, std::abs(profile.at(z) - munk(z)));
    EXPECT_LE(worst, error);
    EXPECT_GT(worst, error / 30);  // no finer than necessary
  }
  // The profile is linear at its quarters, with a bump between them.
  const auto wave = [](double z) { return 1500 + 10 * std::sin(z * std::acos(-1) / 25); };
  const SoundSpeedProfile profile(sample_profile_within(wave, 0, 100, 0.01));
  EXPECT_NEAR(profile.at(12.5), 1510, 0.01);
}

TEST(SoundSpeedProfile, SamplesAtAGivenSpacing) {
  const auto munk = [](double z) { return munk_sound_speed_m_s(z); };
  const auto points = sample_profile(munk, 0, 5000, 10);
  ASSERT_EQ(points.size(), 501u);
  EXPECT_EQ(points[100].depth_m, 1000);
  EXPECT_EQ(points[100].sound_speed_m_s, munk(1000));
  EXPECT_EQ(sample_profile(munk, 0, 25, 10).size(), 4u);
  EXPECT_THROW(sample_profile(munk, 0, 5000, 1e-9), std::invalid_argument);
  EXPECT_THROW(sample_profile(munk, 0, 5000, 0), std::invalid_argument);
  EXPECT_THROW(sample_profile(munk, 5, 5, 1), std::invalid_argument);
  EXPECT_THROW(sample_profile_within(munk, 0, 5000, -1), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
