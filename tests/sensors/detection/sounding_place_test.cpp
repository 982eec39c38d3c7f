// SPDX-License-Identifier: GPL-3.0-or-later
// Tests positions of soundings under one gradient, whose rays are arcs of circles, and in isovelocity
// water.
#include "sensors/detection/sounding_place.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "geometry/numbers/scalars.hpp"
#include "scene/scene_water.hpp"
#include "sensors/detection/bottom_detection.hpp"

namespace tubefoot {
namespace {

constexpr double gradient_per_s = -1, surface_m = 3;

RunContext under_a_gradient() {
  WaterDescription water;
  water.profile = "gradient";
  water.sound_speed_m_s = 1500;
  water.gradient_per_s = gradient_per_s;
  water.profile_bottom_m = 100;
  water.surface_height_m = surface_m;
  RunContext run;
  run.layered_water = std::make_shared<SceneWater>(water);
  return run;
}

double speed_at(double up_m) { return 1500 + gradient_per_s * (surface_m - up_m); }

Recording at_speed(double sound_speed_m_s) {
  Recording recording;
  recording.sound_speed_m_s = sound_speed_m_s;
  return recording;
}

TEST(SoundingPlacer, FollowsTheArcOfTheBeam) {
  const Pose pose{{5, -2, -7}, attitude_from_angles(40 * degree, 3 * degree, -5 * degree)};
  const double c = speed_at(-7);
  // The ranges of the recording may use another speed than that at the sensor: they represent travel times.
  for (const double recorded_m_s : {c, 1480.0}) {
    const SoundingPlacer placer(at_speed(recorded_m_s), under_a_gradient());
    ASSERT_TRUE(placer.traces_rays());
    EXPECT_NEAR(placer.sound_speed_m_s(pose), c, 1e-9);
    for (const double across_deg : {-75.0, -40.0, 0.0, 20.0, 70.0}) {
      const glm::dvec3 axis(std::sin(across_deg * degree), 0, -std::cos(across_deg * degree));
      const double range_m = 60, time_s = range_m / recorded_m_s;
      const glm::dvec3 from = placer.place(pose, axis, range_m) - pose.position_m;
      const glm::dvec3 launch = pose.attitude * axis;
      // cosh(g t) = 1 + g^2 chord^2 / (2 c c') for an arc from c to c'.
      const double there = speed_at(pose.position_m.z + from.z);
      EXPECT_NEAR(std::acosh(1 + gradient_per_s * gradient_per_s * glm::dot(from, from) / (2 * c * there)),
                  time_s * std::abs(gradient_per_s), 1e-9)
          << across_deg;
      // Snell's law at both ends, in the vertical plane of the launch.
      const double level = std::hypot(launch.x, launch.y);
      EXPECT_NEAR((from.x * launch.y - from.y * launch.x) / level, 0, 1e-9);
      const double radius = c / (std::abs(gradient_per_s) * level);  // of the arc
      const glm::dvec3 centre =
          glm::dvec3(launch.x * launch.z / level, launch.y * launch.z / level, -level) * radius;
      EXPECT_NEAR(glm::length(from - centre), radius, 1e-6) << across_deg;
    }
  }
}

TEST(SoundingPlacer, IsTheStraightPlaceInUniformWater) {
  const Pose pose{{5, -2, -7}, attitude_from_angles(0.4, 0.1, -0.2)};
  WaterDescription constant;
  RunContext run;
  run.layered_water = std::make_shared<SceneWater>(constant);
  for (const RunContext& uniform : {RunContext(), run}) {
    const SoundingPlacer placer(at_speed(1490), uniform);
    EXPECT_FALSE(placer.traces_rays());
    EXPECT_EQ(placer.place(pose, {0.6, 0, -0.8}, 30), sounding_position(pose, {0.6, 0, -0.8}, 30));
    EXPECT_EQ(placer.longest_m(30), 30);
    EXPECT_EQ(placer.highest_m(pose, {0, 0, -1}, 30), -7);
  }
  EXPECT_THROW(SoundingPlacer(at_speed(1490), under_a_gradient()).place(pose, {0, 0, -1}, -1),
               std::invalid_argument);
}

// With faster sound below, flat rays turn upwards. Their greatest height bounds the depths that a file must
// represent.
TEST(SoundingPlacer, KnowsHowHighARayComes) {
  WaterDescription water;
  water.profile = "gradient";
  water.sound_speed_m_s = 1480;
  water.gradient_per_s = 2;
  water.profile_bottom_m = 30;
  RunContext run;
  run.layered_water = std::make_shared<SceneWater>(water);
  const Pose pose{{0, 0, -10}, {1, 0, 0, 0}};
  const SoundingPlacer placer(at_speed(1500), run);
  for (const double below_deg : {-10.0, 1.0, 4.0, 30.0}) {
    const glm::dvec3 axis(std::cos(below_deg * degree), 0, -std::sin(below_deg * degree));
    double highest_m = -10;
    for (int k = 0; k <= 400; ++k) highest_m = std::max(highest_m, placer.place(pose, axis, 0.5 * k).z);
    EXPECT_NEAR(placer.highest_m(pose, axis, 200), highest_m, 1e-3) << below_deg;
    EXPECT_GE(placer.highest_m(pose, axis, 200), highest_m - 1e-9) << below_deg;
  }
  EXPECT_NEAR(placer.longest_m(200), 200 * 1540 / 1500.0, 1e-9);
}

}  // namespace
}  // namespace tubefoot
