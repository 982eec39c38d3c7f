// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the axes of other engines. All are rotations. A point ahead, to port and above has the coordinates
// that the documents of each engine state. Angles and quaternions are invertible.
#include "exchange/frames.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <random>

#include "files/usage_error.hpp"

namespace tubefoot {
namespace {

const glm::dvec3 east(1, 0, 0), north(0, 1, 0), up(0, 0, 1), starboard(1, 0, 0), ahead(0, 1, 0);

double distance(const glm::dmat3& a, const glm::dmat3& b) {
  double largest = 0;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) largest = std::max(largest, std::abs(a[c][r] - b[c][r]));
  return largest;
}

TEST(Frames, AreRotationsOfRightHandedAxes) {
  for (const EngineAxes& engine : engine_axes())
    for (const Axes* axes : {&engine.world, &engine.body, &engine.sonar}) {
      const glm::dmat3 m = axes->matrix();
      EXPECT_EQ(glm::determinant(m), 1) << engine.engine << " " << axes->words;
      EXPECT_EQ(distance(m * glm::transpose(m), glm::dmat3(1)), 0) << engine.engine << " " << axes->words;
      const glm::dvec3 p(0.1, -7246504.123456789, 1e-300);
      EXPECT_EQ(axes->to_ours(axes->to_theirs(p)), p);
      EXPECT_EQ(axes->to_theirs(p), m * p);
      EXPECT_FALSE(std::signbit(axes->to_theirs({0, 0, 0}).z));
    }
}

TEST(Frames, PutDirectionsWhereEachEngineSays) {
  const auto& [sdf, stonefish, gltf, obj, holoocean] = engine_axes();
  // SDF and Gazebo: the world is east, north, up; bodies are forward, left, up.
  EXPECT_EQ(sdf.world.to_theirs(north), glm::dvec3(0, 1, 0));
  EXPECT_EQ(sdf.body.to_theirs(ahead), glm::dvec3(1, 0, 0));
  EXPECT_EQ(sdf.body.to_theirs(-starboard), glm::dvec3(0, 1, 0));
  EXPECT_EQ(sdf.body.to_theirs(up), glm::dvec3(0, 0, 1));
  // Stonefish: north, east, down; its sonars look along z, with y down.
  EXPECT_EQ(stonefish.world.to_theirs(north), glm::dvec3(1, 0, 0));
  EXPECT_EQ(stonefish.world.to_theirs(east), glm::dvec3(0, 1, 0));
  EXPECT_EQ(stonefish.world.to_theirs(up), glm::dvec3(0, 0, -1));
  EXPECT_EQ(stonefish.body.to_theirs(-starboard), glm::dvec3(0, -1, 0));
  EXPECT_EQ(stonefish.sonar.to_theirs(ahead), glm::dvec3(0, 0, 1));
  EXPECT_EQ(stonefish.sonar.to_theirs(up), glm::dvec3(0, -1, 0));
  EXPECT_EQ(stonefish.sonar.to_theirs(starboard), glm::dvec3(1, 0, 0));
  // glTF: y up; a camera looks along -z, with x to the right.
  EXPECT_EQ(gltf.world.to_theirs(up), glm::dvec3(0, 1, 0));
  EXPECT_EQ(gltf.world.to_theirs(north), glm::dvec3(0, 0, -1));
  EXPECT_EQ(gltf.sonar.to_theirs(ahead), glm::dvec3(0, 0, -1));
  EXPECT_EQ(gltf.sonar.to_theirs(starboard), glm::dvec3(1, 0, 0));
  EXPECT_EQ(obj.world.to_theirs(north), north);
  // HoloOcean: forward, left, up.
  EXPECT_EQ(holoocean.body.to_theirs(-starboard), glm::dvec3(0, 1, 0));
}

TEST(Frames, PlaceAPointAheadOfATurnedBody) {
  // Heading 90: bow east. A point 3 m ahead of a body at (5, 7, -2) is at (8, 7, -2), in any engine.
  const Placement ours{{5, 7, -2}, glm::mat3_cast(attitude_from_angles(std::numbers::pi / 2, 0, 0))};
  for (const EngineAxes& engine : engine_axes()) {
    const Placement theirs = to_theirs(ours, engine.world, engine.body);
    for (const glm::dvec3 in_body : {glm::dvec3(0, 3, 0), glm::dvec3(-2, 0, 0), glm::dvec3(0, 0, 4)}) {
      const glm::dvec3 seen = theirs.position_m + theirs.turn * engine.body.to_theirs(in_body);
      const glm::dvec3 expected = ours.position_m + ours.turn * in_body;
      EXPECT_LT(glm::length(engine.world.to_ours(seen) - expected), 1e-14) << engine.engine;
    }
    const Placement back = to_ours(theirs, engine.world, engine.body);
    EXPECT_EQ(back.position_m, ours.position_m);
    EXPECT_LT(distance(back.turn, ours.turn), 1e-15);
  }
  // Bow east is yaw 0 where x is forward and east, and yaw 90 degrees where x is north and z down.
  EXPECT_NEAR(roll_pitch_yaw(to_theirs(ours, engine_axes()[0].world, engine_axes()[0].body).turn).z, 0,
              1e-15);
  EXPECT_NEAR(roll_pitch_yaw(to_theirs(ours, engine_axes()[1].world, engine_axes()[1].body).turn).z,
              std::numbers::pi / 2, 1e-15);
}

TEST(Frames, PitchIsBowUpInNorthEastDownAndBowDownInForwardLeftUp) {
  const Placement up_10{{0, 0, 0}, glm::mat3_cast(attitude_from_angles(0, 0.1, 0))};
  EXPECT_NEAR(roll_pitch_yaw(to_theirs(up_10, engine_axes()[1].world, engine_axes()[1].body).turn).y, 0.1,
              1e-15);
  EXPECT_NEAR(roll_pitch_yaw(to_theirs(up_10, engine_axes()[0].world, engine_axes()[0].body).turn).y, -0.1,
              1e-15);
}

TEST(Frames, AnglesAndQuaternionsComeBack) {
  std::mt19937_64 random(20);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 1000; ++k) {
    const glm::dmat3 turn = glm::mat3_cast(
        glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random))));
    EXPECT_LT(distance(turn_of(roll_pitch_yaw(turn)), turn), 1e-14);
    EXPECT_LT(distance(turn_of_quaternion(quaternion_xyzw(turn)), turn), 1e-14);
  }
  // Straight up and down, where roll and yaw have the same axis.
  for (const double pitch : {-std::numbers::pi / 2, std::numbers::pi / 2})
    for (const double roll : {0.0, 0.3, 3.0}) {
      const glm::dmat3 turn = turn_of({roll, pitch, 0.7});
      EXPECT_LT(distance(turn_of(roll_pitch_yaw(turn)), turn), 1e-14);
    }
  // Text of sixteen digits gives exact quarter turns.
  EXPECT_EQ(distance(turn_of({0, 0, 1.5707963267948966}),
                     glm::dmat3(glm::dvec3(0, 1, 0), glm::dvec3(-1, 0, 0), up)),
            0);
  EXPECT_EQ(distance(turn_of({3.141592653589793, 0, 0}), glm::dmat3(east, -north, -up)), 0);
}

TEST(Frames, ThatLookDownHaveAheadDownAndStarboardInItsPlace) {
  EXPECT_EQ(looking_down * ahead, -up);
  EXPECT_EQ(looking_down * starboard, starboard);
  EXPECT_EQ(looking_down * up, ahead);
  EXPECT_EQ(glm::determinant(looking_down), 1);
}

TEST(Frames, HaveNamesThatTheCommandLineKnows) {
  EXPECT_EQ(exchange_format("stonefish"), ExchangeFormat::stonefish);
  for (const EngineAxes& engine : engine_axes())
    EXPECT_EQ(axes_of(exchange_format(engine.engine)).engine, engine.engine);
  EXPECT_THROW(exchange_format("unity"), UsageError);
}

}  // namespace
}  // namespace tubefoot
