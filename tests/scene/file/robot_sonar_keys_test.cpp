// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the keys of sonars of underwater robots: a scanning head, beams at listed angles, and presets of
// products.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/world/read_scenes.hpp"
#include "scene/file/sensor_presets.hpp"
#include "sensors/kinds/kind_imaging.hpp"
#include "sensors/kinds/kind_multibeam.hpp"
#include "sensors/kinds/kind_scanning.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string scene_with_sonar(const std::string& lines) {
  return std::string(smallest_scene) + "[[sensors]]\nname = \"sonar\"\n" + lines;
}
SensorDescription sensor_of(const std::string& lines) {
  return read_scene(TestFolder(), scene_with_sonar(lines)).sensors.back();
}
std::string error_of(const std::string& lines) { return scene_error(TestFolder(), scene_with_sonar(lines)); }

TEST(ScanningKeys, AreAllRead) {
  const auto scan = sensor_of(R"(kind = "scanning"
frequency_khz = 675
scan_deg = 90
step_deg = 1.8
beam_horizontal_deg = 3
beam_vertical_deg = 30
step_interval_s = 0.05
samples = 250
range_min_m = 0.3
range_max_m = 30
)")
                        .kind.as<ScanningDescription>();
  EXPECT_EQ(scan.frequency_khz, 675);
  EXPECT_EQ(scan.scan_deg, 90);
  EXPECT_EQ(scan.step_deg, 1.8);
  EXPECT_EQ(scan.beam_horizontal_deg, 3);
  EXPECT_EQ(scan.beam_vertical_deg, 30);
  EXPECT_EQ(scan.step_interval_s, 0.05);
  EXPECT_EQ(scan.samples, 250);
  EXPECT_EQ(scan.range_min_m, 0.3);
  EXPECT_EQ(scan.range_max_m, 30);
}

TEST(ScanningKeys, MustAgree) {
  EXPECT_THAT(
      error_of("kind = \"scanning\"\nstep_deg = 0.7\n"),
      HasSubstr(
          "'scan_deg' (360) must be a whole multiple of 'step_deg' (0.7) and at most 4096 steps, but it "
          "is 514.286 steps"));
  EXPECT_THAT(error_of("kind = \"scanning\"\nstep_deg = 0.05\n"),
              HasSubstr("at most 4096 steps, but it is 7200"));
  EXPECT_THAT(error_of("kind = \"scanning\"\nrange_min_m = 60\n"), HasSubstr("must be less than"));
  // 400 steps of 2 * 15 / 1500 and 0.02 s.
  EXPECT_THAT(
      error_of("kind = \"scanning\"\nrange_max_m = 15\npings = 2\n"),
      HasSubstr(
          "a ping is a scan of 400 steps, which takes 16 s, so 'ping_interval_s' must be this time or more"));
  EXPECT_EQ(error_of("kind = \"scanning\"\nrange_max_m = 15\npings = 2\nping_interval_s = 16\n"), "");
  EXPECT_EQ(error_of("kind = \"scanning\"\nlook_at_m = [1, 2, 3]\n"), "");
}

TEST(BeamAngles, AreReadInsteadOfWhatSpreadsThem) {
  EXPECT_THAT(sensor_of("kind = \"imaging\"\nbeam_angles_deg = [-20, -5, 3, 30]\n")
                  .kind.as<ImagingDescription>()
                  .beam_angles_deg,
              ElementsAre(-20, -5, 3, 30));
  EXPECT_THAT(sensor_of("kind = \"multibeam\"\nbeam_angles_deg = [-20, 60]\n")
                  .kind.as<MultibeamDescription>()
                  .beam_angles_deg,
              ElementsAre(-20, 60));
  EXPECT_EQ(sensor_of("kind = \"imaging\"\nspacing = \"distance\"\n").kind.as<ImagingDescription>().spacing,
            "distance");
}

TEST(BeamAngles, MustAgree) {
  for (const char* key : {"beams = 3", "horizontal_deg = 30", "spacing = \"angle\""})
    EXPECT_THAT(error_of(std::string("kind = \"imaging\"\nbeam_angles_deg = [-1, 1]\n") + key + "\n"),
                HasSubstr("'beam_angles_deg' already defines the beams: remove '"));
  EXPECT_THAT(error_of("kind = \"multibeam\"\nbeam_angles_deg = [-1, 1]\nswath_deg = 9\n"),
              HasSubstr("remove 'swath_deg' or the list"));
  EXPECT_THAT(error_of("kind = \"imaging\"\nbeam_angles_deg = [1, 1]\n"),
              HasSubstr("must increase, from port to starboard: 1 follows 1"));
  EXPECT_THAT(error_of("kind = \"imaging\"\nbeam_angles_deg = [4]\n"), HasSubstr("two or more angles"));
  EXPECT_THAT(error_of("kind = \"imaging\"\nbeam_angles_deg = [0, 180]\n"), HasSubstr("-179 to 179"));
  EXPECT_THAT(error_of("kind = \"multibeam\"\nbeam_angles_deg = [-80, 89]\nbeam_across_deg = 3\n"),
              HasSubstr("a beam at 89 degrees with a width of 3 degrees reaches above the horizontal"));
  EXPECT_THAT(error_of("kind = \"imaging\"\nspacing = \"distance\"\nbeams = 1\n"), HasSubstr("2 or more"));
}

TEST(BeamAngles, ReplaceWhatAPresetSaysOfThem) {
  const auto fan = sensor_of("preset = \"oculus-m750d-750\"\nbeam_angles_deg = [-2, -1, 2]\n");
  EXPECT_EQ(fan.kind.as<ImagingDescription>().beam_angles_deg.size(), 3u);
  EXPECT_EQ(make_sensor(fan)->beams().size(), 3u);
  EXPECT_EQ(
      make_sensor(sensor_of("preset = \"seabat-t50-400\"\nbeam_angles_deg = [-2, -1, 2]\n"))->beams().size(),
      3u);
}

TEST(Presets, ThatAreNotThereAreNamed) {
  for (const char* kind : {"", "kind = \"scanning\"\n"})
    EXPECT_THAT(
        error_of(std::string(kind) + "preset = \"ping306\"\n"),
        HasSubstr("there is no preset \"ping306\" (did you mean \"ping360\"?): `tubefoot presets` lists"));
}

TEST(Presets, AreSonarsAllOfThem) {
  for (const SensorPreset& preset : sensor_presets()) {
    SCOPED_TRACE(preset.name);
    EXPECT_EQ(error_of("preset = \"" + std::string(preset.name) + "\"\n"), "");
    EXPECT_NO_THROW(
        make_sensor(in_water(sensor_of("preset = \"" + std::string(preset.name) + "\"\n"), 1500)));
  }
}

// Widths of the receive beams between the -3 dB points, as the comments of the presets state.
TEST(Presets, ReceiversAreAsWideAsTheirMakersSay) {
  constexpr double degree = 3.14159265358979 / 180;
  const std::pair<const char*, double> widths_deg[] = {
      {"oculus-m750d-750", 1.0},   {"oculus-m750d-1200", 0.6},  {"oculus-m1200d-1200", 0.6},
      {"oculus-m1200d-2100", 0.4}, {"oculus-m3000d-1200", 0.6}, {"oculus-m3000d-3000", 0.4},
      {"gemini-720is", 1.0},       {"gemini-1200ik-720", 1.0},  {"gemini-1200ik-1200", 0.6},
      {"blueview-p900-130", 1.0}};
  for (const auto& [name, width_deg] : widths_deg) {
    SCOPED_TRACE(name);
    const auto sensor = make_sensor(sensor_of("preset = \"" + std::string(name) + "\"\n"));
    const BeamPatterns patterns = sensor->patterns(Pose{}, 1500);
    const std::size_t beam = sensor->beams().size() / 2;
    const double axis = sensor->beams()[beam].azimuth_rad, off = width_deg / 2 * degree;
    for (const double side : {-1.0, 1.0})
      EXPECT_NEAR(patterns.receive[beam].gain({std::sin(axis + side * off), std::cos(axis + side * off), 0}),
                  0.5, 2e-3);
  }
}

}  // namespace
}  // namespace tubefoot
