// SPDX-License-Identifier: GPL-3.0-or-later
// Tests whole multibeam runs: soundings agree with the seabed, and a target to port ahead has its position
// in each file.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

#include "engine/visibility/tube_engine.hpp"
#include "fixtures/multibeam_runs.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/packet_reader.hpp"
#include "geometry/numbers/scalars.hpp"
#include "run/survey.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

using namespace multibeam_for_tests;

TEST(MultibeamRun, EveryBeamOfAFlatSeabedIsOnItToARangeSample) {
  const TestFolder folder;
  run(folder, flat_scene("heading_deg = 37"));
  for (const char* detection : {"first_return", "energy_centroid", "maximum"}) {
    SCOPED_TRACE(detection);
    const auto soundings = soundings_in(folder / fmt::format("out/{}-soundings.csv", detection));
    ASSERT_EQ(soundings.size(), 101u);
    for (const CsvSounding& s : soundings) {
      SCOPED_TRACE(s.beam);
      const double angle = -75 + 1.5 * double(s.beam);
      EXPECT_NEAR(s.angle_deg, angle, 1e-9);
      // To starboard is 37 degrees south of east.
      EXPECT_NEAR(s.east - 3, s.range * std::sin(angle * degree) * std::cos(37 * degree), 1e-3);
      EXPECT_NEAR(s.north + 2, -s.range * std::sin(angle * degree) * std::sin(37 * degree), 1e-3);
      if (detection == std::string("energy_centroid")) {
        EXPECT_NEAR(s.range, height_m / std::cos(angle * degree), step_m);
        EXPECT_NEAR(s.up, 0, step_m);
        continue;
      }
      // The strongest and the first echo come from the near edge of an ideal beam. They lie in the range
      // bin of this edge, or in the next one if this bin contains too little of the seabed.
      const double near = height_m / std::cos(std::max(std::abs(angle) - 0.75, 0.0) * degree);
      EXPECT_GT(s.range, near - step_m);
      EXPECT_LT(s.range, near + 2 * step_m);
    }
  }
}

TEST(MultibeamRun, ARolledAndPitchedSonarFindsTheSameSeabed) {
  const TestFolder folder;
  run(folder, flat_scene("heading_deg = 250\nroll_deg = -6\npitch_deg = 4"));
  std::size_t seen = 0;
  for (const CsvSounding& s : soundings_in(folder / "out/energy_centroid-soundings.csv")) {
    if (s.range > 85) continue;  // the recording ends within the beam
    EXPECT_NEAR(s.up, 0, step_m) << s.beam;
    ++seen;
  }
  EXPECT_GE(seen, 96u);
}

TEST(MultibeamRun, WithoutAPlaceOnEarthSaysWhatIsLeftOut) {
  const TestFolder folder;
  folder.write("scene.toml", flat_scene(""));
  const Outcome outcome =
      run_program({"run", (folder / "scene.toml").string(), "-o", (folder / "out").string()});
  EXPECT_NE(outcome.err.find("maximum.gsf"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("add [georeference]"), std::string::npos) << outcome.err;
  std::set<std::string> names = names_below(folder / "out");
  for (const char* ending : {"-soundings.csv", "-soundings.gpkg", "-depth.tif", "-depth.png"})
    EXPECT_TRUE(names.contains(std::string("maximum") + ending)) << ending;
  for (const char* name : {"maximum.gsf", "maximum.xtf", "maximum-sonar.nc"})
    EXPECT_FALSE(names.contains(name));
}

/// A box to port ahead, with its top at -24 m, on a seabed at -30 m. The sonar heads east, 10 m deep, with
/// its bow 20 degrees up so that it looks ahead. Port is north, ahead is east.
const char* const port_ahead = R"(
[georeference]
origin_lat_lon_deg = [59.0, 10.0]
[[materials]]
name = "bed"
[[terrain]]
kind = "flat"
width_m = 300
length_m = 300
centre_m = [0, 0, -30]
[[objects]]
name = "target"
shape = "box"
size_m = [4, 4, 6]
position_m = [6.2, 12, -27]
[trajectory]
kind = "fixed"
position_m = [0, 0, -10]
heading_deg = 90
pitch_deg = 20
[[sensors]]
name = "sonar"
preset = "reson-8101"
swath_deg = 120
beams = 81
range_min_m = 1
range_max_m = 61
samples = 1200
)";

bool on_target(double ahead, double to_port, double down) {
  return std::abs(ahead - 6.2) < 2.1 && std::abs(to_port - 12) < 2.1 && down > 13.9 && down < 20;
}

/// The arrays of the first ping of a GSF file by identifier: stored values times their scale.
std::map<unsigned, std::vector<double>> gsf_arrays(const std::filesystem::path& path) {
  samples::PacketReader file(samples::file_content(path), true);
  for (std::size_t at = 0; at < file.size(); at += 8 + file.u32(at)) {
    if ((file.u32(at + 4) & 0x3FFFFF) != 2) continue;
    samples::PacketReader ping(file.part(at + 8, file.u32(at)), true);
    const auto beams = static_cast<std::size_t>(ping.i16(16));
    std::map<unsigned, std::pair<unsigned, double>> scales;  // bytes, multiplier
    std::map<unsigned, std::vector<double>> arrays;
    for (std::size_t place = 56; place + 4 < ping.size();) {
      const unsigned id = ping.u8(place);
      const std::size_t size = ping.u32(place) & 0xFFFFFF;
      place += 4;
      for (std::size_t entry = place + 4; id == 100 && entry < place + size; entry += 12) {
        scales[ping.u8(entry)] = {ping.u8(entry + 1) >> 4, ping.i32(entry + 4)};
        EXPECT_EQ(ping.i32(entry + 8), 0);
      }
      for (std::size_t beam = 0; scales.contains(id) && beam < beams; ++beam) {
        const auto [bytes, multiplier] = scales.at(id);
        const std::size_t field = place + beam * bytes;
        arrays[id].push_back((bytes == 4   ? ping.i32(field)
                              : bytes == 2 ? ping.i16(field)
                                           : ping.i8(field)) /
                             multiplier);
      }
      place += size;
    }
    return arrays;
  }
  throw std::runtime_error("no ping");
}

TEST(MultibeamRun, ATargetToPortAheadIsToPortAheadInEveryFile) {
  const TestFolder folder;
  run(folder, port_ahead);
  std::vector<std::size_t> beams;
  for (const CsvSounding& s : soundings_in(folder / "out/sonar-soundings.csv"))
    if (s.up > -26) {  // the box; beams on its edge find something between it and the seabed
      EXPECT_TRUE(on_target(s.east, s.north, -10 - s.up)) << s.beam;
      EXPECT_LT(s.angle_deg, 0);
      beams.push_back(s.beam);
    }
  ASSERT_GE(beams.size(), 4u);
  for (const std::size_t beam : beams) EXPECT_LT(beam, 40u);

  const auto gsf = gsf_arrays(folder / "out/sonar.gsf");
  const auto nc = [&](const char* name) {
    return NetcdfReader(folder / "out/sonar-sonar.nc").values("/Sonar/Beam_group1/Bathymetry", name);
  };
  const auto ahead = nc("detection_x"), starboard = nc("detection_y"), down = nc("detection_z");
  const auto latitude = nc("detection_latitude"), longitude = nc("detection_longitude");
  for (const std::size_t beam : beams) {
    SCOPED_TRACE(beam);
    EXPECT_TRUE(on_target(gsf.at(3).at(beam), -gsf.at(2).at(beam), gsf.at(1).at(beam) - 10));
    EXPECT_LT(gsf.at(5).at(beam), 0);
    EXPECT_TRUE(on_target(ahead.at(beam), -starboard.at(beam), down.at(beam)));
    // A degree of latitude is 111.4 km long at 59 N, and one of longitude 57.5 km.
    EXPECT_TRUE(on_target((longitude.at(beam) - 10) * 57.5e3, (latitude.at(beam) - 59) * 111.4e3, 15));
  }
  EXPECT_NEAR(gsf.at(1).at(80), 30, 0.1);  // the starboard-most beam
  EXPECT_GT(gsf.at(2).at(80), 30);
}

// Two pings at the shortest interval that a scene permits: each format with times has two different times.
TEST(MultibeamRun, PingsAtTheShortestIntervalHaveTimesOfTheirOwn) {
  const TestFolder folder;
  run(folder, std::string(port_ahead) + "pings = 2\nping_interval_s = 1e-6\n");
  std::set<std::string> names = names_below(folder / "out");
  for (const char* name : {"sonar-sonar.nc", "sonar.gsf", "sonar.xtf"})
    EXPECT_TRUE(names.contains(name)) << name;
}

// The test derives the correct sounding positions from the footprints of each beam, not from the echo.
TEST(MultibeamRun, OnTheRealGridEverySoundingLiesWithinItsFootprintsDepths) {
  const std::filesystem::path data = TUBEFOOT_SOURCE_DIR "/scenes/data/jd211.bag";
  const TestFolder folder;
  run(folder, fmt::format(R"(
[georeference]
crs = "EPSG:32602"
origin_crs = [621930.0, 7245100.0]
[[materials]]
name = "bed"
[[terrain]]
kind = "raster"
file = "{}"
window = [770, 670, 236, 64]
[trajectory]
kind = "line"
start_m = [0, -40, -2]
end_m = [0, 40, -2]
speed_m_s = 4
[[sensors]]
name = "sonar"
preset = "reson-8101"
pings = 7
ping_interval_s = 3
range_min_m = 1
range_max_m = 213
samples = 4240
)",
                          data.string()));
  const auto soundings = soundings_in(folder / "out/sonar-soundings.csv");
  ASSERT_EQ(soundings.size(), 7u * 101);

  const auto survey = open_survey(read_scene_file(folder / "scene.toml"));
  const WorldGrid& grid = survey->scene.grid;
  const TubeEngine engine(survey->scene.mesh, *survey->loaded_scene->tree, grid.unit_m(), {});
  const Sensor& sensor = *survey->sensors[0].sensor;
  for (std::size_t ping = 0; ping < 7; ++ping) {
    const History history = engine.trace(sensor.tubes(survey->sensors[0].poses[ping], grid));
    const double apex_up = grid.to_metres(history.tubes.apex).z;
    std::vector<double> lowest(101, 1e9), highest(101, -1e9);
    for (const Footprint& footprint : history.footprints.footprints)
      for (std::uint32_t p = 0; p < footprint.piece_count; ++p) {
        const Piece& piece = history.footprints.pieces[footprint.first_piece + p];
        for (std::uint32_t c = 0; c < piece.count; ++c) {
          const double up = apex_up + history.footprints.corners_m[piece.first + c].z;
          lowest[sensor.beam_of_tube()[footprint.tube]] =
              std::min(lowest[sensor.beam_of_tube()[footprint.tube]], up);
          highest[sensor.beam_of_tube()[footprint.tube]] =
              std::max(highest[sensor.beam_of_tube()[footprint.tube]], up);
        }
      }
    for (std::size_t beam = 0; beam < 101; ++beam) {
      const CsvSounding& s = soundings[ping * 101 + beam];
      ASSERT_EQ(s.beam, beam);
      EXPECT_GT(s.up, lowest[beam] - step_m) << ping << " " << beam;
      EXPECT_LT(s.up, highest[beam] + step_m) << ping << " " << beam;
    }
  }
}

}  // namespace
}  // namespace tubefoot
