// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the keys of carriers that move during a ping, of stabilised beams, and of shadow borders.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "fixtures/world/read_scenes.hpp"
#include "sensors/kinds/kind_multibeam.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string swath_with(const std::string& keys) {
  return replaced(smallest_scene, "kind = \"didson\"\n", "kind = \"multibeam\"\n" + keys);
}

TEST(MotionKeys, AreRead) {
  const TestFolder folder;
  const SceneDescription scene = read_scene(
      folder, swath_with("stop_and_hop = false\nmotion_step_beams = 0.25\nreceive_along_track_deg = 20\n"
                         "stabilisation = [\"roll\", \"yaw\"]\nstabilisation_heading_s = 4\n"));
  const SensorDescription& sensor = scene.sensors.front();
  EXPECT_FALSE(sensor.stop_and_hop);
  EXPECT_EQ(sensor.motion_step_beams, 0.25);
  const auto& swath = sensor.kind.as<MultibeamDescription>();
  EXPECT_EQ(swath.receive_along_track_deg, 20);
  EXPECT_THAT(swath.stabilisation, ElementsAre("roll", "yaw"));
  EXPECT_EQ(swath.stabilisation_heading_s, 4);
}

TEST(MotionKeys, WithoutEffectAreErrors) {
  const TestFolder folder;
  EXPECT_EQ(scene_error(folder, swath_with("motion_step_beams = 0.2\n")),
            "scene.toml:12:21: 'motion_step_beams' needs stop_and_hop = false: add it, or remove the key");
  EXPECT_EQ(
      scene_error(folder, swath_with("receive_along_track_deg = 20\n")),
      "scene.toml:12:27: 'receive_along_track_deg' needs stop_and_hop = false: add it, or remove the key");
  EXPECT_EQ(scene_error(folder, swath_with("stabilisation = [\"roll\"]\nstabilisation_heading_s = 4\n")),
            "scene.toml:13:27: 'stabilisation_heading_s' needs stabilisation = [\"yaw\"]: add it, or remove "
            "the key");
  EXPECT_THAT(scene_error(folder, swath_with("stabilisation = [\"heave\"]\n")), HasSubstr("\"pitch\""));
  EXPECT_THAT(scene_error(folder, swath_with("stop_and_hop = false\nmotion_step_beams = 0\n")),
              HasSubstr("'motion_step_beams'"));
}

TEST(ShadowKey, IsSharpOrFresnel) {
  const TestFolder folder;
  EXPECT_EQ(read_scene(folder, swath_with("")).sensors.front().shadow, "sharp");
  EXPECT_EQ(read_scene(folder, swath_with("shadow = \"fresnel\"\n")).sensors.front().shadow, "fresnel");
  EXPECT_THAT(scene_error(folder, swath_with("shadow = \"soft\"\n")),
              testing::AllOf(testing::StartsWith("scene.toml:12:"), HasSubstr("\"sharp\""),
                             HasSubstr("\"fresnel\"")));
}

}  // namespace
}  // namespace tubefoot
