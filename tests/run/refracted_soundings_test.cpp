// SPDX-License-Identifier: GPL-3.0-or-later
// Tests soundings under a sound-speed profile in whole runs. The seabed is flat and 30 m deep, and the
// sonar 10 m deep. The sound speed decreases by 1 m/s per metre of depth. With straight rays the outer
// soundings would have errors of 2 m.
#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "fixtures/multibeam_runs.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/packet_reader.hpp"

namespace tubefoot {
namespace {

using namespace multibeam_for_tests;
using testing::Contains;
using testing::ElementsAre;

const std::string gradient_keys =
    "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = -1\nprofile_bottom_m = 40\n";
constexpr double sonar_m = -10, seabed_m = -30;

/// The range gate is long enough that it cuts no beam.
std::string over_a_flat_seabed(const std::string& water, const std::string& sensor) {
  return "[georeference]\norigin_lat_lon_deg = [59.0, 10.0]\n" + water + lambert_material("bed", -27) +
         flat_terrain(300, 300, "centre_m = [0, 0, -30]\n") +
         fixed_at(3, -2, sonar_m, "heading_deg = 37\nroll_deg = 2\n") + "[[sensors]]\nname = \"sonar\"\n" +
         sensor;
}

const std::string fan =
    "preset = \"reson-8101\"\nrange_min_m = 1\nrange_max_m = 131\nsamples = 2600\ngrid_cell_m = 1\n";

/// Travel time of the ray from the sonar to a point, under the gradient.
double travel_time_s(double east_m, double north_m, double up_m) {
  const double c = 1500 + sonar_m, there = 1500 + up_m;
  const double chord2 =
      (east_m - 3) * (east_m - 3) + (north_m + 2) * (north_m + 2) + (up_m - sonar_m) * (up_m - sonar_m);
  return std::acosh(1 + chord2 / (2 * c * there));
}

struct GsfContent {
  std::vector<std::string> parameters;
  std::vector<std::pair<double, double>> profile;  ///< depth, sound speed
  std::vector<double> depth_m;                     ///< of the first ping
};
GsfContent gsf_in(const std::filesystem::path& path) {
  samples::PacketReader file(samples::file_content(path), true);
  GsfContent content;
  for (std::size_t at = 0; at < file.size(); at += 8 + file.u32(at)) {
    samples::PacketReader record(file.part(at + 8, file.u32(at)), true);
    const unsigned id = file.u32(at + 4);
    if (id == 4)
      for (std::size_t k = 0, place = 10; k < record.u16(8); ++k, place += 2 + record.u16(place))
        content.parameters.push_back(record.text(place + 2, record.u16(place)));
    if (id == 3)
      for (std::size_t k = 0; k < record.u32(24); ++k)
        content.profile.emplace_back(record.u32(28 + 8 * k) / 100.0, record.u32(32 + 8 * k) / 100.0);
    if (id != 2 || !content.depth_m.empty()) continue;
    for (std::size_t place = 56; place + 4 < record.size();) {
      const unsigned array = record.u8(place);
      const std::size_t size = record.u32(place) & 0xFFFFFF;
      place += 4;
      if (array == 1)
        for (std::size_t beam = 0; beam < size / 4; ++beam)
          content.depth_m.push_back(record.u32(place + 4 * beam) / 1000.0);
      place += size;
    }
  }
  return content;
}

TEST(RefractedSoundings, OfAFlatSeabedLieOnItInEveryFile) {
  const TestFolder folder;
  run(folder, over_a_flat_seabed(gradient_keys, fan));
  const auto soundings = soundings_in(folder / "out/sonar-soundings.csv");
  ASSERT_EQ(soundings.size(), 101u);
  const GsfContent gsf = gsf_in(folder / "out/sonar.gsf");
  ASSERT_EQ(gsf.depth_m.size(), 101u);
  const NetcdfReader netcdf(folder / "out/sonar-sonar.nc");
  const auto down = netcdf.values("/Sonar/Beam_group1/Bathymetry", "detection_z");
  for (const CsvSounding& s : soundings) {
    SCOPED_TRACE(s.angle_deg);
    EXPECT_NEAR(s.up, seabed_m, 0.1);
    EXPECT_NEAR(travel_time_s(s.east, s.north, s.up), s.range / 1490, 2e-7);
    EXPECT_NEAR(gsf.depth_m[s.beam], -s.up, 2e-3);
    EXPECT_NEAR(down[s.beam], sonar_m - s.up, 2e-3);
  }
  GDALAllRegister();
  const GDALDatasetUniquePtr grid(GDALDataset::Open((folder / "out/sonar-depth.tif").c_str()));
  ASSERT_TRUE(grid);
  std::vector<float> depths(std::size_t(grid->GetRasterXSize()) * std::size_t(grid->GetRasterYSize()));
  ASSERT_EQ(grid->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, grid->GetRasterXSize(), grid->GetRasterYSize(),
                                             depths.data(), grid->GetRasterXSize(), grid->GetRasterYSize(),
                                             GDT_Float32, 0, 0),
            CE_None);
  std::size_t cells = 0;
  for (const float depth : depths)
    if (depth > -32768) {
      ++cells;
      EXPECT_NEAR(depth, -seabed_m, 0.1);
    }
  EXPECT_GT(cells, 100u);
}

TEST(RefractedSoundings, SayInGsfWhatWasDoneAndByWhichProfile) {
  const TestFolder folder;
  run(folder, over_a_flat_seabed(gradient_keys, fan));
  const GsfContent traced = gsf_in(folder / "out/sonar.gsf");
  EXPECT_THAT(traced.parameters, Contains("DEPTH_CALCULATION=CORRECTED"));
  EXPECT_THAT(traced.parameters, Contains("RAY_TRACING=YES"));
  EXPECT_THAT(traced.profile, ElementsAre(std::pair(0.0, 1500.0), std::pair(40.0, 1460.0)));
  std::filesystem::remove_all(folder / "out");
  run(folder, over_a_flat_seabed("[water]\nsound_speed_m_s = 1480\n", fan));
  const GsfContent straight = gsf_in(folder / "out/sonar.gsf");
  EXPECT_THAT(straight.parameters, Contains("DEPTH_CALCULATION=CORRECTED"));
  EXPECT_THAT(straight.parameters, Contains("RAY_TRACING=NO"));
  EXPECT_THAT(straight.profile, ElementsAre(std::pair(0.0, 1480.0)));
  std::filesystem::remove_all(folder / "out");
  // A water surface 2 m above height 0, from which the file counts its depths, and a profile that begins
  // below.
  folder.write("profile.csv", "depth_m,sound_speed_m_s\n5,1500\n5.001,1500.001\n25,1490\n");
  run(folder,
      over_a_flat_seabed(
          "[water]\nprofile = \"table\"\nprofile_file = \"profile.csv\"\nsurface_height_m = 2\n", fan));
  EXPECT_THAT(gsf_in(folder / "out/sonar.gsf").profile,
              ElementsAre(std::pair(0.0, 1500.0), std::pair(3.0, 1500.0), std::pair(23.0, 1490.0)));
}

// A beam tilted by 40 degrees, whose width there equals the length of its range bins.
TEST(RefractedSoundings, OfAnEchosounderLieOnTheRayOfItsAxis) {
  const TestFolder folder;
  std::string scene = over_a_flat_seabed(
      gradient_keys,
      "kind = \"echosounder\"\nbeam_deg = 1\nrange_min_m = 1\nrange_max_m = 41\nsamples = 4000\n");
  scene.replace(scene.find("roll_deg = 2"), 12, "roll_deg = 40");
  run(folder, scene);
  const auto rows = csv_rows(folder / "out/sonar.csv");
  ASSERT_EQ(rows.size(), 1u);
  const auto number = [&](const char* name) { return std::stod(rows[0].at(name)); };
  EXPECT_NEAR(number("bottom_up_m"), seabed_m, 0.05);
  EXPECT_NEAR(travel_time_s(number("bottom_east_m"), number("bottom_north_m"), number("bottom_up_m")),
              number("range_m") / 1490, 2e-7);
}

TEST(RefractedSoundings, OfAnInterferometerLieOnTheSeabed) {
  const TestFolder folder;
  run(folder, over_a_flat_seabed(gradient_keys,
                                 "kind = \"interferometric\"\nfrequency_khz = 100\nbaseline_m = 0.007\n"
                                 "along_track_deg = 2\ndepression_min_deg = 10\ndepression_max_deg = 70\n"
                                 "range_min_m = 24\nrange_max_m = 84\nsamples = 240\n"));
  std::size_t seen = 0;
  for (const auto& row : csv_rows(folder / "out/sonar-soundings.csv")) {
    const auto number = [&](const char* name) { return std::stod(row.at(name)); };
    const double range_m = number("range_m");
    if (range_m < 26 || range_m > 80) continue;  // the borders of the sector cut range bins
    SCOPED_TRACE(range_m);
    EXPECT_NEAR(number("up_m"), seabed_m, 0.25);
    EXPECT_NEAR(travel_time_s(number("east_m"), number("north_m"), number("up_m")), range_m / 1490, 2e-7);
    ++seen;
  }
  EXPECT_GT(seen, 300u);
}

}  // namespace
}  // namespace tubefoot
