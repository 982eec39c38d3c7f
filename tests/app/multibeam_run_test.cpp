// SPDX-License-Identifier: GPL-3.0-or-later
// The multibeam through the whole program: soundings agree with the bed, and a target to port ahead is where
// it is in every file.
#include <fmt/format.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <netcdf.h>
#include <ogrsf_frmts.h>

#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <regex>
#include <set>
#include <sstream>

#include "app/program.hpp"
#include "app/survey.hpp"
#include "engine/tube_engine.hpp"
#include "sensors/packet_reader.hpp"

namespace tubefoot {
namespace {

constexpr double degree = std::numbers::pi / 180;

/// A CSV file by column name, as texts.
std::vector<std::map<std::string, std::string>> rows_of(const std::filesystem::path& file) {
  std::istringstream text(bytes_of(file));
  const auto cells_of = [](const std::string& row) {
    std::vector<std::string> cells;
    std::istringstream stream(row);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    return cells;
  };
  std::string line;
  std::getline(text, line);
  const std::vector<std::string> names = cells_of(line);
  std::vector<std::map<std::string, std::string>> rows;
  while (std::getline(text, line)) {
    const std::vector<std::string> values = cells_of(line);
    if (values.size() != names.size()) throw std::runtime_error("a row of another length: " + line);
    rows.emplace_back();
    for (std::size_t k = 0; k < names.size(); ++k) rows.back()[names[k]] = values[k];
  }
  return rows;
}

struct CsvSounding {
  std::size_t ping, beam;
  double east, north, up, range, angle_deg;
};

std::vector<CsvSounding> soundings_in(const std::filesystem::path& file) {
  std::vector<CsvSounding> soundings;
  for (const auto& row : rows_of(file)) {
    const auto number = [&](const char* name) { return std::stod(row.at(name)); };
    soundings.push_back({std::size_t(number("ping")), std::size_t(number("beam")), number("east_m"),
                         number("north_m"), number("up_m"), number("slant_range_m"),
                         number("beam_angle_deg_starboard_positive")});
  }
  return soundings;
}

void run(const TestFolder& folder, const std::string& scene) {
  folder.write("scene.toml", scene);
  const Outcome outcome =
      run_program({"run", (folder / "scene.toml").string(), "-o", (folder / "out").string(), "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
}

constexpr double height_m = 20, step_m = 0.05;

std::string flat_scene(const std::string& pose) {
  std::string scene = fmt::format(R"(
[[materials]]
name = "bed"
[[terrain]]
kind = "flat"
width_m = 400
length_m = 400
[trajectory]
kind = "fixed"
position_m = [3, -2, {}]
{}
)",
                                  height_m, pose);
  for (const char* detection : {"first_return", "energy_centroid", "maximum"})
    scene += fmt::format(
        "[[sensors]]\nname = \"{0}\"\npreset = \"reson-8101\"\ndetection = \"{0}\"\nrange_min_m = 1\n"
        "range_max_m = 91\nsamples = 1800\n",
        detection);
  return scene;
}

TEST(MultibeamRun, EveryBeamOfAFlatBedIsOnItToARangeSample) {
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
      // The strongest and the first echo come from the near edge of an ideal beam, in the sample that holds
      // it or, if that sample holds too little of the bed, in the next.
      const double near = height_m / std::cos(std::max(std::abs(angle) - 0.75, 0.0) * degree);
      EXPECT_GT(s.range, near - step_m);
      EXPECT_LT(s.range, near + 2 * step_m);
    }
  }
}

TEST(MultibeamRun, ARolledAndPitchedSonarFindsTheSameBed) {
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

/// Rows of the depth grid, and how many of its cells within 14 m of the track have no depth.
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

// Pings a metre apart over cells of a metre: the line may start on the cells' borders, or roll and pitch.
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
    run(folder, fmt::format(R"(
[[materials]]
name = "bed"
[[terrain]]
kind = "flat"
width_m = 400
length_m = 400
[trajectory]
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

// Every kind of sonar, with and without a receiver that does something: what it shows, beside the ideal
// picture.
TEST(ReceivedPictures, OfEveryKindAreThereWhereTheReceiverDoesSomething) {
  const TestFolder folder;
  const auto pictures = [&](const std::string& receiver) {
    std::string scene = R"(
[[materials]]
name = "bed"
[[terrain]]
kind = "flat"
width_m = 60
length_m = 60
[trajectory]
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
  EXPECT_EQ(pictures(""), (std::set<std::string>{"swath-phase-received.png"}));  // it asks for phase noise
  EXPECT_EQ(pictures("speckle = \"rayleigh\"\nnoise_level_db = 90"),
            (std::set<std::string>{
                "camera-0000-received.png", "camera-0001-received.png", "camera-0002-received.png",
                "camera-sequence-received.png", "fish-received.png", "imaging-0000-received.png",
                "imaging-0001-received.png", "imaging-0002-received.png", "imaging-sequence-received.png",
                "multibeam-depth-ideal.png", "sounder-received.png", "swath-phase-received.png",
                "swath-received.png"}));
}

// Beams whose echo goes on beyond the range window.
TEST(MultibeamRun, ABeamThatTheWindowCutsIsFlaggedInEveryFile) {
  const TestFolder folder;
  run(folder, "[georeference]\norigin_lat_lon_deg = [59, 10]\n" +
                  std::regex_replace(flat_scene(""), std::regex("range_max_m = 91\nsamples = 1800"),
                                     "range_max_m = 61\nsamples = 1200"));
  std::size_t cut = 0;
  std::map<std::size_t, std::string> status;
  for (const auto& row : rows_of(folder / "out/energy_centroid-soundings.csv")) {
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
  EXPECT_EQ(cut, 2u);  // at 70.5 degrees, either side

  int file = 0, sonar = 0, beams = 0, bathymetry = 0, variable = 0;
  ASSERT_EQ(nc_open((folder / "out/energy_centroid-sonar.nc").c_str(), NC_NOWRITE, &file), NC_NOERR);
  ASSERT_EQ(nc_inq_ncid(file, "Sonar", &sonar), NC_NOERR);
  ASSERT_EQ(nc_inq_ncid(sonar, "Beam_group1", &beams), NC_NOERR);
  ASSERT_EQ(nc_inq_ncid(beams, "Bathymetry", &bathymetry), NC_NOERR);
  ASSERT_EQ(nc_inq_varid(bathymetry, "status", &variable), NC_NOERR);
  std::vector<signed char> flags(101);
  ASSERT_EQ(nc_get_var_schar(bathymetry, variable, flags.data()), NC_NOERR);
  nc_close(file);
  for (std::size_t beam = 0; beam < 101; ++beam)
    EXPECT_EQ(flags[beam], !status.contains(beam) ? 2 : status[beam] == "good" ? 0 : 1) << beam;

  const std::unique_ptr<GDALDataset> points(GDALDataset::Open(
      (folder / "out/energy_centroid-soundings.gpkg").c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
  ASSERT_TRUE(points);
  for (const auto& point : *points->GetLayer(0))
    EXPECT_EQ(point->GetFieldAsString("status"), status.at(point->GetFieldAsInteger64("beam")));

  // Beam flags of GSF are array 16: its subrecord's head is the number and the size.
  const std::string gsf = bytes_of(folder / "out/energy_centroid.gsf");
  const std::size_t head = gsf.find(std::string("\x10\0\0\x65", 4));
  ASSERT_NE(head, gsf.npos);
  for (std::size_t beam = 0; beam < 101; ++beam)
    EXPECT_EQ(gsf[head + 4 + beam], !status.contains(beam) ? 1 : status[beam] == "good" ? 0 : 9) << beam;
}

// Two crossed lines of 0.21 m: what lights the bed goes on beyond the outermost beams, and their mean echo
// lies near the axis; no other way of detection is better (docs/sensors.md has the table).
TEST(MultibeamRun, BeamsOfTwoCrossedLinesFindAFlatBed) {
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

/// A box to port ahead, top at -24 m, on a bed at -30 m; the sonar heads east, 10 m deep, its bow 20 degrees
/// up so that it looks ahead. Port is north, ahead is east.
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

/// The arrays of the first ping of a GSF file: by identifier, as they are stored times their scale.
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

std::vector<double> netcdf_values(const std::filesystem::path& path, const char* group, const char* name) {
  int file = -1, id = -1, variable = -1, dimensions = 0;
  if (nc_open(path.c_str(), NC_NOWRITE, &file) || nc_inq_grp_full_ncid(file, group, &id) ||
      nc_inq_varid(id, name, &variable) || nc_inq_varndims(id, variable, &dimensions))
    throw std::runtime_error(fmt::format("no {} in {} of {}", name, group, path.string()));
  std::vector<int> ids(static_cast<std::size_t>(dimensions));
  nc_inq_vardimid(id, variable, ids.data());
  std::size_t size = 1;
  for (const int dimension : ids) {
    std::size_t length = 0;
    nc_inq_dimlen(id, dimension, &length);
    size *= length;
  }
  std::vector<double> values(size);
  EXPECT_EQ(nc_get_var_double(id, variable, values.data()), NC_NOERR);
  nc_close(file);
  return values;
}

TEST(MultibeamRun, ATargetToPortAheadIsToPortAheadInEveryFile) {
  const TestFolder folder;
  run(folder, port_ahead);
  std::vector<std::size_t> beams;
  for (const CsvSounding& s : soundings_in(folder / "out/sonar-soundings.csv"))
    if (s.up > -26) {  // the box; beams on its edge find something between it and the bed
      EXPECT_TRUE(on_target(s.east, s.north, -10 - s.up)) << s.beam;
      EXPECT_LT(s.angle_deg, 0);
      beams.push_back(s.beam);
    }
  ASSERT_GE(beams.size(), 4u);
  for (const std::size_t beam : beams) EXPECT_LT(beam, 40u);

  const auto gsf = gsf_arrays(folder / "out/sonar.gsf");
  const auto nc = [&](const char* name) {
    return netcdf_values(folder / "out/sonar-sonar.nc", "/Sonar/Beam_group1/Bathymetry", name);
  };
  const auto ahead = nc("detection_x"), starboard = nc("detection_y"), down = nc("detection_z");
  const auto latitude = nc("detection_latitude"), longitude = nc("detection_longitude");
  for (const std::size_t beam : beams) {
    SCOPED_TRACE(beam);
    EXPECT_TRUE(on_target(gsf.at(3).at(beam), -gsf.at(2).at(beam), gsf.at(1).at(beam) - 10));
    EXPECT_LT(gsf.at(5).at(beam), 0);
    EXPECT_TRUE(on_target(ahead.at(beam), -starboard.at(beam), down.at(beam)));
    // A degree of latitude is 111.4 km long at 59 N, one of longitude 57.5 km.
    EXPECT_TRUE(on_target((longitude.at(beam) - 10) * 57.5e3, (latitude.at(beam) - 59) * 111.4e3, 15));
  }
  EXPECT_NEAR(gsf.at(1).at(80), 30, 0.1);  // the starboard-most beam
  EXPECT_GT(gsf.at(2).at(80), 30);
}

// Where soundings must lie is taken from what each beam sees of the bed, not from the echo.
TEST(MultibeamRun, OnTheRealGridEverySoundingLiesWithinItsFootprintsDepths) {
  const std::filesystem::path data = std::filesystem::path(TUBEFOOT_SHARED_DATA) / "jd211.bag";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "no " << data;
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
  const TubeEngine engine(survey->scene.mesh, *survey->tree, grid.unit_m(), {});
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
