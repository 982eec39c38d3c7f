// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/world/read_scenes.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string smallest_scene_with(const std::string& lines) { return std::string(smallest_scene) + lines; }

TEST(BeamPatternKeys, AreReadForBothSides) {
  const TestFolder folder;
  folder.write("beam.csv", "angle_deg,level_db\n0,0\n1,-3\n");
  const SensorDescription sensor =
      read_scene(folder,
                 smallest_scene_with("transmit_pattern = \"table\"\ntransmit_pattern_angle = \"elevation\"\n"
                                     "transmit_pattern_file = \"beam.csv\"\nreceive_pattern = \"line\"\n"
                                     "receive_aperture_m = 0.1\n"))
          .sensors.front();
  EXPECT_EQ(sensor.transmit.pattern, "table");
  EXPECT_EQ(sensor.transmit.angle, "elevation");
  EXPECT_EQ(*sensor.transmit.file, folder.path() / "beam.csv");
  EXPECT_EQ(sensor.transmit.file_place.line, 14);
  EXPECT_EQ(sensor.receive.pattern, "line");
  EXPECT_EQ(*sensor.receive.aperture_m, 0.1);
  EXPECT_EQ(sensor.receive.angle, "azimuth");
}

TEST(BeamPatternKeys, EachGoesToItsSide) {
  const TestFolder folder;
  folder.write("beam.csv", "angle_deg,level_db\n0,0\n1,-3\n");
  using Of = const PatternDescription& (*)(const SensorDescription&);
  const std::pair<std::string, Of> sides[] = {
      {"transmit", [](const SensorDescription& s) -> const PatternDescription& { return s.transmit; }},
      {"receive", [](const SensorDescription& s) -> const PatternDescription& { return s.receive; }}};
  for (const auto& [side, of] : sides) {
    const auto read = [&, &name = side, get = of](const std::string& pattern, const std::string& key) {
      return get(read_scene(folder, smallest_scene_with(name + "_pattern = \"" + pattern + "\"\n" + name +
                                                        key + "\n"))
                     .sensors.front());
    };
    EXPECT_EQ(read("piston", "_aperture_m = 0.25").aperture_m, 0.25);
    EXPECT_EQ(read("gaussian", "_beam_width_deg = 1.5").width_deg, 1.5);
    EXPECT_EQ(read("table", "_pattern_file = \"beam.csv\"").file, folder.path() / "beam.csv");
    EXPECT_EQ(read("gaussian", "_beam_width_deg = 1\n" + side + "_pattern_angle = \"off_axis\"").angle,
              "off_axis");
  }
}

TEST(BeamPatternKeys, TableCountsInTheSceneHash) {
  const TestFolder folder;
  const std::string scene =
      smallest_scene_with("receive_pattern = \"table\"\nreceive_pattern_file = \"beam.csv\"\n");
  folder.write("beam.csv", "angle_deg,level_db\n0,0\n1,-3\n");
  const std::string before = read_scene(folder, scene).sha256;
  folder.write("beam.csv", "angle_deg,level_db\n0,0\n1,-4\n");
  EXPECT_NE(read_scene(folder, scene).sha256, before);
}

TEST(BeamPatternKeys, MistakesAreReportedWithTheirPlace) {
  const struct {
    const char *lines, *place, *says;
  } mistakes[] = {
      {"receive_pattern = \"lime\"\n", "12:19", "did you mean \"line\"?"},
      {"receive_pattern = \"line\"\n", "12:19",
       "receive_pattern = \"line\" needs the key 'receive_aperture_m'"},
      {"transmit_pattern = \"piston\"\n", "12:20", "needs the key 'transmit_aperture_m'"},
      {"transmit_pattern = \"gaussian\"\n", "12:20", "needs the key 'transmit_beam_width_deg'"},
      {"receive_pattern = \"table\"\n", "12:19", "needs the key 'receive_pattern_file'"},
      {"receive_aperture_m = 1\n", "12:22",
       "'receive_aperture_m' applies to receive_pattern = \"line\" or \"piston\", not to receive_pattern = "
       "\"none\""},
      {"receive_pattern = \"gaussian\"\nreceive_beam_width_deg = 1\nreceive_aperture_m = 1\n", "14:22",
       "not to receive_pattern = \"gaussian\""},
      {"receive_pattern = \"piston\"\nreceive_aperture_m = 1\nreceive_pattern_angle = \"azimuth\"\n", "14:25",
       "'receive_pattern_angle' applies to"},
      {"receive_pattern = \"line\"\nreceive_aperture_m = 1\nreceive_pattern_angle = \"off_axis\"\n", "14:25",
       "not on \"off_axis\""},
      {"receive_pattern = \"line\"\nreceive_aperture_m = 0\n", "13:22", "must be > 0, <= 1000 metres"},
      {"receive_pattern = \"piston\"\nreceive_aperture_m = 1\nreceive_shading = 0.5\n", "14:19",
       "'receive_shading' applies to receive_pattern = \"line\", not to receive_pattern = \"piston\""},
      {"receive_pattern = \"line\"\nreceive_aperture_m = 1\nreceive_shading = 1.5\n", "14:19",
       "must be 0 to 1"},
      {"receive_pattern = \"gaussian\"\nreceive_beam_width_rad = 1\n", "13:1", "give it in degrees"},
      {"receive_pattern = \"table\"\nreceive_pattern_file = \"no.csv\"\n", "13:24", "there is no file"},
  };
  const TestFolder folder;
  for (const auto& m : mistakes) {
    const std::string error = scene_error(folder, smallest_scene_with(m.lines));
    EXPECT_THAT(error, StartsWith(std::string("scene.toml:") + m.place + ": ")) << m.lines;
    EXPECT_THAT(error, HasSubstr(m.says)) << m.lines;
  }
}

}  // namespace
}  // namespace tubefoot
