// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the keys of surveys, of sloping seabeds and of sensors that look at a position.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/world/read_scenes.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::Optional;

constexpr std::string_view lines = "kind = \"survey\"\nlength_m = 300\nwidth_m = 120\nspacing_m = 40\n";

SurveyTrajectory survey(const std::string& keys) {
  const TestFolder folder;
  const SceneDescription scene =
      read_scene(folder, replaced(smallest_scene, "kind = \"fixed\"", std::string(lines) + keys));
  return std::get<SurveyTrajectory>(scene.trajectories.at(0).kind);
}

TEST(TrackKeys, OfASurvey) {
  const SurveyTrajectory full = survey(
      "centre_m = [5, -6]\nheading_deg = 25\none_way = true\nspeed_m_s = 1.5\nturn_s = 90\naltitude_m = 12\n"
      "altitude_step_m = 3\npitch_deg = 2\nroll_deg = -1");
  EXPECT_THAT(full.centre_m, ElementsAre(5, -6));
  EXPECT_EQ(full.length_m, 300);
  EXPECT_EQ(full.width_m, 120);
  EXPECT_EQ(full.spacing_m, 40);
  EXPECT_EQ(full.heading_deg, 25);
  EXPECT_TRUE(full.one_way);
  EXPECT_EQ(full.speed_m_s, 1.5);
  EXPECT_EQ(full.turn_s, 90);
  EXPECT_THAT(full.altitude_m, Optional(12.0));
  EXPECT_THAT(full.altitude_step_m, Optional(3.0));
  EXPECT_FALSE(full.up_m || full.depth_m);
  EXPECT_EQ(full.pitch_deg, 2);
  EXPECT_EQ(full.roll_deg, -1);

  const SurveyTrajectory on_earth = survey("centre_lat_lon_deg = [48.5, -4]\ndepth_m = 7");
  EXPECT_THAT(on_earth.centre_lat_lon_deg, Optional(ElementsAre(48.5, -4)));
  EXPECT_THAT(on_earth.depth_m, Optional(7.0));
  EXPECT_EQ(on_earth.turn_s, 60);
  EXPECT_EQ(on_earth.speed_m_s, 1);
  EXPECT_FALSE(on_earth.one_way);
  const SurveyTrajectory on_map = survey("centre_crs = [400000, 5.4e6]\nup_m = -3");
  EXPECT_THAT(on_map.centre_crs, Optional(ElementsAre(400000, 5.4e6)));
  EXPECT_THAT(on_map.up_m, Optional(-3.0));
}

TEST(TrackKeys, OfWaypointsWithoutTimes) {
  const TestFolder folder;
  folder.write("way.csv", "east_m,north_m,up_m\n0,0,0\n0,9,0\n");
  const SceneDescription scene =
      read_scene(folder, replaced(smallest_scene, "kind = \"fixed\"",
                                  "kind = \"waypoints\"\nfile = \"way.csv\"\nspeed_m_s = 2\nturn_s = 30"));
  const auto& way = std::get<WaypointTrajectory>(scene.trajectories.at(0).kind);
  EXPECT_THAT(way.speed_m_s, Optional(2.0));
  EXPECT_EQ(way.turn_s, 30);
}

TEST(TrackKeys, OfSlopesAndSensors) {
  const TestFolder folder;
  const SceneDescription scene = read_scene(
      folder,
      replaced(replaced(smallest_scene, "kind = \"flat\"",
                        "kind = \"flat\"\nslope_deg = 6\nslope_heading_deg = 90"),
               "kind = \"didson\"\n",
               "kind = \"didson\"\nlook_at_m = [1, 2, -3]\ndisplay_gain_db = 6\nwindow_start_m = 0\n"));
  EXPECT_EQ(std::get<FlatTerrain>(scene.terrains.at(0).kind).slope_deg, 6);
  EXPECT_EQ(std::get<FlatTerrain>(scene.terrains.at(0).kind).slope_heading_deg, 90);
  EXPECT_THAT(scene.sensors.at(0).look_at_m, Optional(ElementsAre(1, 2, -3)));
  EXPECT_EQ(scene.sensors.at(0).signal.display_gain_db, 6);
}

}  // namespace
}  // namespace tubefoot
