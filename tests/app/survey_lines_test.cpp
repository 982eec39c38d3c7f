// SPDX-License-Identifier: GPL-3.0-or-later
// Tests surveys by lines in whole runs: over a slope, on a map, with altitudes, echoes and soundings that
// are kept line by line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "fixtures/netcdf_reader.hpp"
#include "fixtures/packet_reader.hpp"
#include "fixtures/program.hpp"
#include "fixtures/test_folder.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

constexpr std::string_view scene = R"([georeference]
crs = "EPSG:32632"
origin_crs = [400000, 5400000]
[[materials]]
name = "sand"
[[terrain]]
kind = "flat"
width_m = 160
length_m = 160
cell_m = 20
slope_deg = 6
slope_heading_deg = 90
centre_m = [0, 0, -20]
[trajectory]
kind = "survey"
centre_crs = [400000, 5400000]
length_m = 60
width_m = 60
spacing_m = 30
altitude_m = 6
speed_m_s = 2
[[sensors]]
name = "side"
kind = "sidescan"
range_min_m = 0
range_max_m = 30
samples = 60
ping_interval_s = 5
)";

TEST(SurveyLinesRun, KeepsEveryPingAtItsAltitudeAndEveryLineByItself) {
  const TestFolder folder;
  const auto file = folder.write("scene.toml", scene);
  const Outcome checked = run_program({"check", file.string()});
  ASSERT_EQ(checked.exit_code, 0) << checked.err;
  EXPECT_THAT(checked.out, HasSubstr("side: 21 pings on 3 lines, 2 beams"));
  const Outcome outcome = run_program({"run", file.string(), "-o", (folder / "out").string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const NetcdfReader echoes(folder / "out/echoes.nc");
  const auto line = echoes.values("/", "line"), at = echoes.values("/", "sensor_position"),
             energy = echoes.values("/", "energy"), heading = echoes.values("/", "sensor_heading");
  ASSERT_EQ(line.size(), 21u);
  for (std::size_t ping = 0; ping < 21; ++ping) {
    EXPECT_EQ(line[ping], 1 + ping / 7);
    const double east = at[3 * ping], up = at[3 * ping + 2];
    EXPECT_NEAR(east, 30.0 * double(ping / 7) - 30, 1e-9);
    EXPECT_NEAR(up, -20 - east * 0.1051042353 + 6, 1e-5);  // tan 6 degrees
    EXPECT_NEAR(heading[ping], ping / 7 == 1 ? 180 : 0, 1e-9);
    // No energy returns before the seabed, which is 6 m cos 6 degrees away. All later range bins have
    // energy.
    for (std::size_t side = 0; side < 2; ++side) {
      for (std::size_t k = 0; k < 11; ++k) EXPECT_EQ(energy[(2 * ping + side) * 60 + k], 0);
      EXPECT_GT(energy[(2 * ping + side) * 60 + 13], 0);
    }
  }
  for (const char* name :
       {"side-line-01.xtf", "side-line-03.xtf", "side-line-02-mosaic.tif", "side-mosaic.png"})
    EXPECT_TRUE(std::filesystem::exists(folder / "out" / name)) << name;
}

/// Number of records of each kind in a GSF file.
std::map<unsigned, int> gsf_records(const std::filesystem::path& path) {
  samples::PacketReader file(samples::file_content(path), true);
  std::map<unsigned, int> records;
  for (std::size_t at = 0; at < file.size(); at += 8 + file.u32(at)) ++records[file.u32(at + 4)];
  return records;
}

/// The ping numbers of the multibeam packets of an XTF file, and the depth of the sonar in its header.
std::pair<std::vector<unsigned>, double> xtf_pings(const std::filesystem::path& path) {
  samples::PacketReader file(samples::file_content(path), false);
  std::vector<unsigned> pings;
  for (std::size_t at = 1024; at < file.size(); at += file.u32(at + 10))
    if (file.u8(at + 2) == 28) pings.push_back(file.u32(at + 28));
  return {pings, file.f32(256 + 56)};
}

// A width of 61 m at intervals of 15 m gives five lines.
TEST(SurveyLinesRun, KeepsTheSoundingsOfAMultibeamLineByLine) {
  const TestFolder folder;
  std::string text(scene);
  text.replace(text.find("spacing_m = 30"), 14, "spacing_m = 15");
  text.replace(text.find("[[sensors]]"), std::string::npos, R"([[sensors]]
name = "fan"
kind = "multibeam"
beams = 9
swath_deg = 80
beam_across_deg = 5
along_track_deg = 5
range_min_m = 1
range_max_m = 25
samples = 240
ping_interval_s = 10
)");
  const auto file = folder.write("scene.toml", text);
  const Outcome outcome = run_program({"run", file.string(), "-o", (folder / "out").string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  unsigned number = 0;
  for (int line = 1; line <= 5; ++line) {
    SCOPED_TRACE(line);
    const std::string stem = (folder / "out/fan-line-0").string() + std::to_string(line);
    EXPECT_THAT(outcome.err + outcome.out, HasSubstr("fan-line-0")) << "the files are named";
    const auto records = gsf_records(stem + ".gsf");
    EXPECT_EQ(records, (std::map<unsigned, int>{{1, 1}, {2, 4}, {3, 1}, {4, 1}}));
    const auto [pings, depth_m] = xtf_pings(stem + ".xtf");
    ASSERT_EQ(pings.size(), 4u);
    for (const unsigned ping : pings) EXPECT_EQ(ping, number++);
    // Along the slope the carrier keeps its depth: 6 m above the seabed.
    EXPECT_NEAR(depth_m, 20 + (15.0 * line - 45) * 0.1051042353 - 6, 1e-4);
  }
  EXPECT_EQ(number, 20u);
  for (const char* name : {"fan.gsf", "fan.xtf", "fan-line-06.gsf"})
    EXPECT_FALSE(std::filesystem::exists(folder / "out" / name)) << name;
  EXPECT_TRUE(std::filesystem::exists(folder / "out/fan-sonar.nc")) << "holds all lines";
}

}  // namespace
}  // namespace tubefoot
