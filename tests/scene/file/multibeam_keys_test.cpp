// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/world/read_scenes.hpp"
#include "sensors/kinds/kind_multibeam.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

/// A scene with a multibeam that has these keys, too.
std::string scene_with_multibeam(const std::string& lines) {
  return std::string(smallest_scene) + "[[sensors]]\nname = \"hull\"\n" + lines;
}

MultibeamDescription fan_of(const std::string& lines) {
  return read_scene(TestFolder(), scene_with_multibeam(lines)).sensors.back().kind.as<MultibeamDescription>();
}

TEST(MultibeamKeys, AreAllRead) {
  const MultibeamDescription fan = fan_of(R"(kind = "multibeam"
frequency_khz = 300
beams = 7
swath_deg = 120
spacing = "distance"
beam_across_deg = 2
along_track_deg = 3
samples = 500
range_min_m = 3
range_max_m = 60
detection = "maximum"
detection_threshold_db = -12
grid_cell_m = 0.5
)");
  EXPECT_EQ(fan.frequency_khz, 300);
  EXPECT_EQ(fan.beams, 7);
  EXPECT_EQ(fan.swath_deg, 120);
  EXPECT_EQ(fan.spacing, "distance");
  EXPECT_EQ(fan.beam_across_deg, 2);
  EXPECT_EQ(fan.along_track_deg, 3);
  EXPECT_EQ(fan.samples, 500);
  EXPECT_EQ(fan.range_min_m, 3);
  EXPECT_EQ(fan.range_max_m, 60);
  EXPECT_EQ(fan.detection, "maximum");
  EXPECT_EQ(fan.detection_threshold_db, -12);
  EXPECT_EQ(fan.grid_cell_m, 0.5);
}

TEST(MultibeamKeys, PresetHasThePublishedFiguresOfThe8101) {
  const TestFolder folder;
  const SensorDescription sensor =
      read_scene(folder, scene_with_multibeam("preset = \"reson-8101\"\n")).sensors.back();
  EXPECT_EQ(sensor.signal.source_level_db, 210);
  const auto& fan = sensor.kind.as<MultibeamDescription>();
  EXPECT_EQ(fan.frequency_khz, 240);
  EXPECT_EQ(fan.beams, 101);
  EXPECT_EQ(fan.swath_deg, 150);
  EXPECT_EQ(fan.beam_across_deg, 1.5);
  EXPECT_EQ(fan.along_track_deg, 1.5);
  EXPECT_EQ(fan.range_max_m, 300);
  EXPECT_NEAR((fan.range_max_m - fan.range_min_m) / fan.samples, 0.05, 1e-12);
}

TEST(MultibeamKeys, MustAgree) {
  const auto error_of = [](const std::string& lines) {
    return scene_error(TestFolder(), scene_with_multibeam("kind = \"multibeam\"\n" + lines));
  };
  EXPECT_THAT(error_of("range_min_m = 100\n"),
              HasSubstr("'range_min_m' (100) must be less than 'range_max_m'"));
  EXPECT_THAT(error_of("beam_across_deg = 31\n"),
              HasSubstr("the outermost beams reach above the horizontal"));
  EXPECT_THAT(error_of("swath_deg = 179\n"), HasSubstr("together must be at most 180"));
  EXPECT_THAT(error_of("detection_threshold_db = 1\n"), HasSubstr("detection_threshold_db"));
  EXPECT_EQ(error_of("beams = 1\nbeam_across_deg = 40\n"), "");  // a single beam has no swath
}

}  // namespace
}  // namespace tubefoot
