// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the keys of the assumed configuration: [processing], [processing.water] and [sensors.processing].
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/world/read_scenes.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Optional;

SceneDescription with_processing(const TestFolder& folder, const std::string& lines) {
  return read_scene(folder, std::string(smallest_scene) + lines);
}

TEST(ProcessingKeys, AreRead) {
  const TestFolder folder;
  const auto tide = folder.write("tide.csv", "time_s,tide_m\n0,0\n");
  const SceneDescription scene = with_processing(
      folder,
      "[sensors.processing]\nyaw_deg = 1\ntilt_deg = 2\nroll_deg = 3\nlever_arm_m = [1, 2, 3]\n"
      "[processing]\nsound_speed_at_transducer_m_s = 1480\nlatency_s = 0.2\nattitude_latency_s = -0.1\n"
      "tide_m = 0.5\ntide_file = \"tide.csv\"\nattitude_bias_deg = [1, 2, 3]\n"
      "attitude_drift_deg_per_hour = [4, 5, 6]\nattitude_noise_deg = [0.1, 0.2, 0.3]\n"
      "position_bias_m = [-1, 2, -3]\nposition_drift_m_per_hour = [7, 8, 9]\n"
      "position_noise_m = [0.4, 0.5, 0.6]\nseed = 18446744\n"
      "[processing.water]\nprofile = \"gradient\"\nsound_speed_m_s = 1490\ngradient_per_s = 0.1\n"
      "profile_bottom_m = 50\n");
  const AssumedMountingDescription& mounting = scene.sensors.at(0).assumed;
  EXPECT_THAT(mounting.yaw_deg, Optional(1.0));
  EXPECT_THAT(mounting.tilt_deg, Optional(2.0));
  EXPECT_THAT(mounting.roll_deg, Optional(3.0));
  EXPECT_THAT(mounting.lever_arm_m, Optional(ElementsAre(1, 2, 3)));
  EXPECT_EQ(scene.sensors.at(0).roll_deg, 0);
  const ProcessingDescription& p = scene.processing;
  EXPECT_THAT(p.sound_speed_at_transducer_m_s, Optional(1480.0));
  EXPECT_EQ(p.latency_s, 0.2);
  EXPECT_EQ(p.attitude_latency_s, -0.1);
  EXPECT_EQ(p.tide_m, 0.5);
  EXPECT_EQ(p.tide_file, tide);
  EXPECT_THAT(scene.inputs, testing::Contains(tide));
  EXPECT_THAT(p.attitude_bias_deg, ElementsAre(1, 2, 3));
  EXPECT_THAT(p.attitude_drift_deg_per_hour, ElementsAre(4, 5, 6));
  EXPECT_THAT(p.attitude_noise_deg, ElementsAre(0.1, 0.2, 0.3));
  EXPECT_THAT(p.position_bias_m, ElementsAre(-1, 2, -3));
  EXPECT_THAT(p.position_drift_m_per_hour, ElementsAre(7, 8, 9));
  EXPECT_THAT(p.position_noise_m, ElementsAre(0.4, 0.5, 0.6));
  EXPECT_EQ(p.seed, 18446744u);
  ASSERT_TRUE(p.water);
  EXPECT_EQ(p.water->profile, "gradient");
  EXPECT_THAT(p.water->sound_speed_m_s, Optional(1490.0));
  EXPECT_FALSE(scene.water.sound_speed_m_s);
}

TEST(ProcessingKeys, DefaultToTheTruth) {
  const TestFolder folder;
  const SceneDescription scene = with_processing(folder, "");
  EXPECT_FALSE(scene.processing.water);
  EXPECT_FALSE(scene.processing.sound_speed_at_transducer_m_s);
  EXPECT_EQ(scene.processing.latency_s, 0);
  EXPECT_THAT(scene.processing.attitude_bias_deg, ElementsAre(0, 0, 0));
  EXPECT_FALSE(scene.sensors.at(0).assumed.yaw_deg);
}

TEST(ProcessingKeys, RejectsInvalidValues) {
  const TestFolder folder;
  const auto error = [&](const std::string& lines) {
    return scene_error(folder, std::string(smallest_scene) + lines);
  };
  EXPECT_THAT(error("[processing]\nattitude_noise_deg = [0.1, -0.1, 0]\n"),
              HasSubstr("scene.toml:13:28: 'attitude_noise_deg'"));
  EXPECT_THAT(error("[processing]\nposition_noise_m = [0, 0, -1e-9]\n"), HasSubstr("'position_noise_m'"));
  EXPECT_THAT(error("[processing]\nattitude_bias_deg = [1, 2]\n"), HasSubstr("3 numbers"));
  EXPECT_THAT(error("[processing]\nposition_bias_m = 1\n"), HasSubstr("3 numbers"));
  EXPECT_THAT(error("[processing]\nlatency_ms = 100\n"), HasSubstr("give it in seconds, as 'latency_s'"));
  EXPECT_THAT(error("[processing]\ntide_file = \"none.csv\"\n"), HasSubstr("scene.toml:13:13"));
  EXPECT_THAT(error("[processing.water]\nabsorption_db_per_km = 10\n"),
              HasSubstr("unknown key 'absorption_db_per_km' in [processing.water]"));
  EXPECT_THAT(error("[processing.water]\nprofile = \"table\"\n"), HasSubstr("needs 'profile_file'"));
  EXPECT_THAT(error("[sensors.processing]\npitch_deg = 1\n"), HasSubstr("unknown key 'pitch_deg'"));
  EXPECT_THAT(error("look_at_m = [0, 9, -2]\n[sensors.processing]\nyaw_deg = 1\n"),
              HasSubstr("'look_at_m' already sets the direction"));
  EXPECT_EQ(error("look_at_m = [0, 9, -2]\n[sensors.processing]\nlever_arm_m = [1, 0, 0]\n"), "");
}

}  // namespace
}  // namespace tubefoot
