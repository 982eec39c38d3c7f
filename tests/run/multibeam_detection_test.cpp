// SPDX-License-Identifier: GPL-3.0-or-later
// Tests multibeam detection: positions of soundings, flags, and the depth grid of round numbers. It also
// tests the pictures of each kind of sonar besides its ideal picture.
#include <fmt/format.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <array>
#include <cmath>
#include <iostream>
#include <regex>
#include <set>

#include "fixtures/multibeam_runs.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using namespace multibeam_for_tests;

/// Returns the rows of the depth grid, and the number of its cells within 14 m of the track without a
/// depth.
std::pair<int, int> rows_and_holes(const std::filesystem::path& file) {
  GDALAllRegister();
  const std::unique_ptr<GDALDataset> data(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER));
  if (!data) throw std::runtime_error("GDAL cannot read " + file.string());
  const int columns = data->GetRasterXSize(), rows = data->GetRasterYSize();
  std::array<double, 6> place{};
  std::vector<float> depth(static_cast<std::size_t>(columns) * rows);
  if (data->GetGeoTransform(place.data()) != CE_None ||
      data->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, columns, rows, depth.data(), columns, rows, GDT_Float32,
                                       0, 0) != CE_None)
    throw std::runtime_error("no depths");
  int holes = 0;
  for (int column = 0; column < columns; ++column)
    for (int row = 1; row + 1 < rows; ++row)  // the line may end within a row
      if (std::abs(place[0] + (column + 0.5) * place[1]) < 14 && depth[row * columns + column] == -32768)
        ++holes;
  return {rows, holes};
}

// Pings a metre apart over cells of a metre: the line may start on the cell borders, or roll and pitch.
TEST(MultibeamRun, PingsAsFarApartAsCellsLeaveNoRowOfTheGridEmpty) {
  const TestFolder folder;
  std::string rolling = "time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg\n";
  for (int k = 0; k <= 60; ++k)
    rolling += fmt::format("{},0,{},20,{},{},{}\n", k, -30 + k, 2 * std::sin(0.3 * k),
                           0.4 * std::sin(2.1 * k), std::sin(1.3 * k));
  folder.write("rolling.csv", rolling);
  const std::string straight =
      "kind = \"line\"\nstart_m = [0, -30, 20]\nend_m = [0, 30, 20]\nspeed_m_s = 1\n";
  const std::string waypoints = "kind = \"waypoints\"\nfile = \"rolling.csv\"\n";
  for (const auto& [name, track, cell] :
       {std::tuple{"straight", straight, "grid_cell_m = 1"}, std::tuple{"by itself", straight, ""},
        std::tuple{"rolling", waypoints, "grid_cell_m = 1"}}) {
    SCOPED_TRACE(name);
    run(folder, lambert_material("bed", -27) + flat_terrain(400, 400) +
                    fmt::format(R"([trajectory]
{}
[[sensors]]
name = "sonar"
preset = "reson-8101"
swath_deg = 90
beams = 61
pings = 61
ping_interval_s = 1
range_max_m = 60
samples = 1200
{}
)",
                                track, cell));
    const auto [rows, holes] = rows_and_holes(folder / "out/sonar-depth.tif");
    EXPECT_GE(rows, 61);
    EXPECT_EQ(holes, 0);
    std::filesystem::remove_all(folder / "out");
  }
}

// Lists the pictures of each kind of sonar besides the ideal picture, with and without receiver effects.
TEST(ReceivedPictures, OfEveryKindAreThereWhereTheReceiverDoesSomething) {
  const TestFolder folder;
  const auto pictures = [&](const std::string& receiver) {
    std::string scene = lambert_material("bed", -27) + flat_terrain(60, 60) + R"([trajectory]
kind = "line"
start_m = [0, -2, 8]
end_m = [0, 2, 8]
)";
    for (const auto& [name, keys] : std::initializer_list<std::pair<const char*, const char*>>{
             {"camera",
              "kind = \"didson\"\nbeams = 12\nsamples = 60\ntilt_deg = 40\nwindow_start_m = 8\n"
              "window_length_m = 12"},
             {"imaging", "kind = \"imaging\"\nbeams = 12\nsamples = 60\ntilt_deg = 40\nrange_max_m = 25"},
             {"fish", "kind = \"sidescan\"\nsamples = 100\nrange_max_m = 30\ndepression_min_deg = 10"},
             {"swath",
              "preset = \"geoswath-250\"\nsamples = 100\nrange_max_m = 30\nphase_noise = true\n"
              "depression_min_deg = 10"},
             {"sounder", "kind = \"echosounder\"\nsamples = 200\nrange_max_m = 20"},
             {"multibeam", "preset = \"reson-8101\"\nsamples = 300\nrange_max_m = 30"}})
      scene += "[[sensors]]\nname = \"" + std::string(name) + "\"\npings = 3\nping_interval_s = 0.5\n" +
               keys + "\n" + receiver + "\n";
    run(folder, scene);
    std::set<std::string> found;
    for (const std::string& name : names_below(folder / "out"))
      if (name.ends_with("-received.png") || name.ends_with("-ideal.png")) found.insert(name);
    std::filesystem::remove_all(folder / "out");
    return found;
  };
  // the option requests phase noise
  EXPECT_EQ(pictures(""), (std::set<std::string>{"swath-phase-received.png"}));
  EXPECT_EQ(pictures("speckle = \"rayleigh\"\nnoise_level_db = 90"),
            (std::set<std::string>{
                "camera-0000-received.png", "camera-0001-received.png", "camera-0002-received.png",
                "camera-sequence-received.png", "fish-received.png", "imaging-0000-received.png",
                "imaging-0001-received.png", "imaging-0002-received.png", "imaging-sequence-received.png",
                "multibeam-depth-ideal.png", "sounder-received.png", "swath-phase-received.png",
                "swath-received.png"}));
}

// Beams whose echo extends beyond the range gate.
TEST(MultibeamRun, ABeamThatTheWindowCutsIsFlaggedInEveryFile) {
  const TestFolder folder;
  run(folder, "[georeference]\norigin_lat_lon_deg = [59, 10]\n" +
                  std::regex_replace(flat_scene(""), std::regex("range_max_m = 91\nsamples = 1800"),
                                     "range_max_m = 61\nsamples = 1200"));
  std::size_t cut = 0;
  std::map<std::size_t, std::string> status;
  for (const auto& row : csv_rows(folder / "out/energy_centroid-soundings.csv")) {
    const double angle = std::stod(row.at("beam_angle_deg_starboard_positive")) * degree,
                 off = std::stod(row.at("slant_range_m")) - height_m / std::cos(angle);
    status[std::stoul(row.at("beam"))] = row.at("status");
    if (row.at("status") == "cut_by_window") {
      ++cut;
      EXPECT_LT(off, -step_m);
      continue;
    }
    EXPECT_EQ(row.at("status"), "good");
    EXPECT_NEAR(off, 0, step_m);
  }
  EXPECT_EQ(cut, 2u);  // at 70.5 degrees, on either side

  const std::vector<double> flags =
      NetcdfReader(folder / "out/energy_centroid-sonar.nc").values("/Sonar/Beam_group1/Bathymetry", "status");
  ASSERT_EQ(flags.size(), 101u);
  for (std::size_t beam = 0; beam < 101; ++beam)
    EXPECT_EQ(flags[beam], !status.contains(beam) ? 2 : status[beam] == "good" ? 0 : 1) << beam;

  GDALAllRegister();
  const std::unique_ptr<GDALDataset> points(GDALDataset::Open(
      (folder / "out/energy_centroid-soundings.gpkg").c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
  ASSERT_TRUE(points);
  for (const auto& point : *points->GetLayer(0))
    EXPECT_EQ(point->GetFieldAsString("status"), status.at(point->GetFieldAsInteger64("beam")));

  // Beam flags of GSF are array 16: the head of the subrecord is the number and the size.
  const std::string gsf = bytes_of(folder / "out/energy_centroid.gsf");
  const std::size_t head = gsf.find(std::string("\x10\0\0\x65", 4));
  ASSERT_NE(head, gsf.npos);
  for (std::size_t beam = 0; beam < 101; ++beam)
    EXPECT_EQ(gsf[head + 4 + beam], !status.contains(beam) ? 1 : status[beam] == "good" ? 0 : 9) << beam;
}

// Two crossed lines of 0.21 m: the insonified seabed extends beyond the outermost beams, and their mean
// echo lies near the axis. No other detection method is better (see the table in docs/sensors.md).
TEST(MultibeamRun, BeamsOfTwoCrossedLinesFindAFlatSeabed) {
  const TestFolder folder;
  std::string scene = std::regex_replace(flat_scene(""), std::regex("range_max_m = 91\nsamples = 1800"),
                                         "range_max_m = 301\nsamples = 6000\n"
                                         "transmit_pattern = \"line\"\ntransmit_aperture_m = 0.21\n"
                                         "receive_pattern = \"line\"\nreceive_pattern_angle = \"elevation\"\n"
                                         "receive_aperture_m = 0.21");
  scene = std::regex_replace(scene, std::regex("(width|length)_m = 400"), "$1_m = 1200");
  run(folder, scene);
  const auto worst = [&](const char* detection, double within_deg) {
    double most = 0;
    for (const CsvSounding& s : soundings_in(folder / fmt::format("out/{}-soundings.csv", detection)))
      if (std::abs(s.angle_deg) <= within_deg + 0.01)
        most = std::max(most, std::abs(s.range - height_m / std::cos(s.angle_deg * degree)));
    return most;
  };
  for (const char* any : {"first_return", "energy_centroid", "maximum"})
    std::cout << any << ": " << worst(any, 60) << " m within 60 degrees, " << worst(any, 70)
              << " m within 70, " << worst(any, 75) << " m within 75\n";
  EXPECT_LT(worst("energy_centroid", 60), 0.03);
  EXPECT_LT(worst("energy_centroid", 70), 0.35);
  EXPECT_LT(worst("energy_centroid", 75), 1.0);
  for (const char* other : {"maximum", "first_return"}) {
    EXPECT_GT(worst(other, 60), 5 * worst("energy_centroid", 60)) << other;
    EXPECT_GT(worst(other, 75), 2 * worst("energy_centroid", 75)) << other;
  }
}

}  // namespace
}  // namespace tubefoot
