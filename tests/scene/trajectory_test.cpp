// SPDX-License-Identifier: GPL-3.0-or-later
// Tests attitudes and trajectories: order and signs of rotations, linear interpolation of positions,
// constant turn rates, and valid times.

#include "scene/trajectory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

#include "fixtures/geometry/near.hpp"
#include "scene/tracks.hpp"

namespace tubefoot {
namespace {

using test::expect_near;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kRight = std::numbers::pi / 2;
const glm::dvec3 kStarboard(1, 0, 0), kForward(0, 1, 0), kUp(0, 0, 1);

TEST(Attitude, IdentityLooksNorth) { expect_near(attitude_from_angles(0, 0, 0) * kForward, {0, 1, 0}); }

TEST(Attitude, HeadingTurnsClockwiseFromNorth) {
  const glm::dquat east = attitude_from_angles(kRight, 0, 0);
  expect_near(east * kForward, {1, 0, 0});
  expect_near(east * kStarboard, {0, -1, 0});
}

TEST(Attitude, PitchRaisesTheBowAndRollLowersStarboard) {
  expect_near(attitude_from_angles(0, kRight, 0) * kForward, {0, 0, 1});
  expect_near(attitude_from_angles(0, 0, kRight) * kStarboard, {0, 0, -1});
  expect_near(attitude_from_angles(0, 0, kRight) * kUp, {1, 0, 0});
}

TEST(Attitude, RollActsFirstThenPitchThenHeading) {
  // Bow up by 30 degrees, heading east: forward points above east for any roll.
  const glm::dquat q = attitude_from_angles(kRight, glm::radians(30.0), glm::radians(70.0));
  expect_near(q * kForward, {std::cos(glm::radians(30.0)), 0, 0.5});
}

Trajectory two_poses(double heading_a_deg, double heading_b_deg) {
  return Trajectory({{10, {{0, 0, -1}, attitude_from_angles(glm::radians(heading_a_deg), 0, 0)}},
                     {20, {{4, 8, -3}, attitude_from_angles(glm::radians(heading_b_deg), 0, 0)}}});
}

TEST(Trajectory, MovesLinearlyAndTurnsAtAConstantRate) {
  const Trajectory t = two_poses(10, 50);
  expect_near(t.at(10).position_m, {0, 0, -1});
  expect_near(t.at(12.5).position_m, {1, 2, -1.5});
  expect_near(t.at(20).position_m, {4, 8, -3});
  for (double s : {0.0, 0.25, 0.5, 0.9, 1.0}) {
    const double heading = glm::radians(10 + 40 * s);
    expect_near(t.at(10 + 10 * s).attitude * kForward, {std::sin(heading), std::cos(heading), 0});
  }
}

TEST(Trajectory, TurnsAlongTheShorterArc) {
  expect_near(two_poses(350, 10).at(15).attitude * kForward, {0, 1, 0});
  expect_near(two_poses(10, -350 + 20).at(15).attitude * kForward,
              {std::sin(glm::radians(20.0)), std::cos(glm::radians(20.0)), 0});
}

TEST(Trajectory, HoldsWithinItsTimesOnly) {
  const Trajectory t = two_poses(0, 0);
  EXPECT_THROW(t.at(9.999), std::out_of_range);
  EXPECT_THROW(t.at(20.001), std::out_of_range);
  EXPECT_THROW(t.at(std::nan("")), std::out_of_range);
  EXPECT_NO_THROW(t.at(20.000000000000004));  // 200 * 0.1 may give this
  const Trajectory fixed({{0, {{1, 2, 3}, {1, 0, 0, 0}}}});
  expect_near(fixed.at(-1e9).position_m, {1, 2, 3});
}

TEST(Trajectory, RefusesNoSamplesAndTimesThatDoNotIncrease) {
  EXPECT_THROW(Trajectory({}), std::invalid_argument);
  EXPECT_THROW(Trajectory(std::vector<Trajectory::Sample>(2)), std::invalid_argument);
}

TEST(LineTrajectory, KeepsItsSpeedAndLooksAlongItself) {
  TrajectoryDescription description;
  description.kind = LineTrajectory{{10, 20, -5}, {40, -20, -5}, 2.0, 0, 0};
  const Trajectory t = make_trajectory(description, {});
  EXPECT_EQ(t.begin_s(), 0);
  EXPECT_DOUBLE_EQ(t.end_s(), 25);  // 50 m at 2 m/s
  EXPECT_NEAR(glm::distance(t.at(3).position_m, t.at(8.5).position_m), 11, 1e-12);
  expect_near(t.at(7).attitude * kForward, {0.6, -0.8, 0});
}

TEST(LineTrajectory, RefusesALineWithoutHeadingAndASpeedOfZero) {
  TrajectoryDescription description;
  description.place = {"scene.toml", 7, 1};
  description.kind = LineTrajectory{{1, 1, 0}, {1, 1, -9}, 1, 0, 0};
  EXPECT_THAT([&] { make_trajectory(description, {}); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:7:1"), HasSubstr("no heading"))));
  description.kind = LineTrajectory{{1, 1, 0}, {1, 2, 0}, 0, 0, 0};
  EXPECT_THAT([&] { make_trajectory(description, {}); }, ThrowsMessage<InputError>(HasSubstr("speed")));
}

TEST(LineTrajectory, IsNotDividedIntoLinesOfASurvey) {
  TrajectoryDescription description;
  description.kind = LineTrajectory{{0, 0, 0}, {0, 9, 0}, 1, 0, 0};
  EXPECT_TRUE(make_trajectory(description, {}).lines().empty());
}

TEST(Trajectory, RefusesLinesOutOfOrderAndBeyondItsTimes) {
  const std::vector<Trajectory::Sample> samples{{0, {}}, {10, {{0, 9, 0}, {1, 0, 0, 0}}}};
  EXPECT_NO_THROW(Trajectory(samples, {{0, 4}, {5, 10}}));
  EXPECT_THROW(Trajectory(samples, {{5, 10}, {0, 4}}), std::invalid_argument);
  EXPECT_THROW(Trajectory(samples, {{0, 4}, {5, 11}}), std::invalid_argument);
  EXPECT_THROW(Trajectory(samples, {{4, 3}}), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
