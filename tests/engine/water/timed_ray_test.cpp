// SPDX-License-Identifier: GPL-3.0-or-later
// Tests rays of a given direction and travel time. The comparisons are straight lines, closed forms,
// Runge-Kutta integration, and eigenrays to the end points.

#include "engine/water/timed_ray.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/water/eigenray.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

RayDirection falling(double degrees) { return {std::sin(degrees * degree), std::cos(degrees * degree)}; }

/// A thermocline over a layer of one gradient, and a channel below it.
SoundSpeedProfile several_layers() {
  return SoundSpeedProfile({{0, 1520}, {8, 1519}, {20, 1485}, {60, 1480}, {90, 1480}, {200, 1495}});
}

/// Integrates the ray equations dx/dt = c cos, dz/dt = c sin, d(angle)/dt = -c' cos by the Runge-Kutta
/// method of fourth order.
TimedRay integrated(const SoundSpeedProfile& profile, double depth_m, double angle_rad, double time_s) {
  struct State {
    double x, z, angle;
  };
  const auto slope = [&](const State& s) -> State {
    const std::size_t layer = profile.layer_at(s.z);
    const double c = profile.speed_in(layer, s.z), g = profile.gradient_per_s(layer);
    return {c * std::cos(s.angle), c * std::sin(s.angle), -g * std::cos(s.angle)};
  };
  const auto moved = [](const State& s, const State& by, double h) -> State {
    return {s.x + h * by.x, s.z + h * by.z, s.angle + h * by.angle};
  };
  State state{0, depth_m, angle_rad};
  double shallowest_m = depth_m;
  constexpr int steps = 200'000;
  const double h = time_s / steps;
  for (int k = 0; k < steps; ++k) {
    const State a = slope(state), b = slope(moved(state, a, h / 2)), c = slope(moved(state, b, h / 2)),
                d = slope(moved(state, c, h));
    state = {state.x + h / 6 * (a.x + 2 * b.x + 2 * c.x + d.x),
             state.z + h / 6 * (a.z + 2 * b.z + 2 * c.z + d.z),
             state.angle + h / 6 * (a.angle + 2 * b.angle + 2 * c.angle + d.angle)};
    shallowest_m = std::min(shallowest_m, state.z);
  }
  return {state.x, state.z, shallowest_m};
}

TEST(TimedRay, IsAStraightLineInUniformWater) {
  const SoundSpeedProfile water(1500);
  for (const double angle : {-90.0, -30.0, 0.0, 12.0, 60.0, 90.0}) {
    const TimedRay ray = ray_after(water, 10, falling(angle), 0.1);
    EXPECT_NEAR(ray.range_m, 150 * std::cos(angle * degree), 1e-12) << angle;
    EXPECT_NEAR(ray.depth_m, 10 + 150 * std::sin(angle * degree), 1e-12) << angle;
    EXPECT_NEAR(ray.shallowest_m, std::min(10.0, ray.depth_m), 1e-12) << angle;
  }
}

// Straight down through c = c0 + g z: z = (c0 / g) (exp(g t) - 1).
TEST(TimedRay, FallsVerticallyThroughAGradient) {
  const SoundSpeedProfile water({{0, 1500}, {1000, 1600}});
  const TimedRay down = ray_after(water, 0, {1, 0}, 0.25), up = ray_after(water, 500, {-1, 0}, 0.2);
  EXPECT_EQ(down.range_m, 0);
  EXPECT_NEAR(down.depth_m, 15000 * std::expm1(0.025), 1e-9);
  EXPECT_NEAR(up.depth_m, 15500 * std::exp(-0.02) - 15000, 1e-9);
}

TEST(TimedRay, AgreesWithTheRayEquationsThroughLayersAndTurns) {
  const SoundSpeedProfile water = several_layers();
  for (const double depth_m : {3.0, 20.0, 75.0})
    for (const double angle : {-80.0, -20.0, -2.0, 0.5, 4.0, 35.0, 88.0}) {
      const TimedRay traced = ray_after(water, depth_m, falling(angle), 0.4),
                     truth = integrated(water, depth_m, angle * degree, 0.4);
      // An integration step across a layer border has an error of first order.
      EXPECT_NEAR(traced.range_m, truth.range_m, 2e-3) << depth_m << ' ' << angle;
      EXPECT_NEAR(traced.depth_m, truth.depth_m, 2e-3) << depth_m << ' ' << angle;
      EXPECT_NEAR(traced.shallowest_m, truth.shallowest_m, 2e-3) << depth_m << ' ' << angle;
    }
}

TEST(TimedRay, EndsWhereTheEigenrayOfItsDirectionAndTimeEnds) {
  const WaterColumn water{several_layers(), {}};
  int turned = 0;
  for (const double source_m : {2.0, 15.0, 80.0}) {
    const EigenrayFinder finder(water, source_m, {.most_turns = 2});
    for (const double depth_m : {1.0, 14.0, 30.0, 110.0})
      for (const double range_m : {0.0, 5.0, 150.0, 900.0})
        for (const Eigenray& ray : finder.all(depth_m, range_m)) {
          const TimedRay there =
              ray_after(water.profile, source_m, {ray.launch_sine, ray.launch_cosine}, ray.time_s);
          EXPECT_NEAR(there.range_m, range_m, 1e-6) << source_m << ' ' << depth_m << ' ' << range_m;
          EXPECT_NEAR(there.depth_m, depth_m, 1e-6) << source_m << ' ' << depth_m << ' ' << range_m;
          turned += ray.turns > 0;
        }
  }
  EXPECT_GT(turned, 5);
}

// A ray on the axis of a channel that is horizontal except for rounding crosses the axis indefinitely.
TEST(TimedRay, StaysOnTheAxisOfAChannel) {
  const SoundSpeedProfile water({{0, 1500}, {50, 1480}, {100, 1500}});
  for (const double sine : {0.0, 1e-17, -1e-12, 1e-7}) {
    const TimedRay ray = ray_after(water, 50, {sine, 1}, 2);
    EXPECT_NEAR(ray.depth_m, 50, 1e-6) << sine;
    EXPECT_NEAR(ray.range_m, 2960, 1e-6) << sine;
  }
}

TEST(TimedRay, RejectsTimesThatAreNone) {
  for (const double time_s : {-1e-9, std::nan(""), HUGE_VAL})
    EXPECT_THROW(ray_after(SoundSpeedProfile(1500), 0, {1, 0}, time_s), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
