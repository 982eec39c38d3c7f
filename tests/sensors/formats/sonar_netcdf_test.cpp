// SPDX-License-Identifier: GPL-3.0-or-later
// Reads files back with the netCDF library by path, type, dimension and unit. The convention's tables
// define these (SONAR-netCDF4 2.0; XSF 0.7 for the group Bathymetry).
#include "sensors/formats/sonar_netcdf.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <thread>

#include "fixtures/full_disk.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/world/recordings.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr std::size_t kBeams = 5;

SonarNetcdfHeader header() {
  SonarNetcdfHeader h;
  h.title = "a line";
  h.summary = "five beams over a bed";
  h.keywords = "sonar, simulation";
  h.date_created = "2024-05-06T07:08:09Z";
  h.software_version = "0.1.0";
  h.history = "2024-05-06T07:08:09Z tubefoot: simulated";
  h.source_files = {"scene.toml", "bed.tif"};
  h.sonar_model = "8101";
  h.beams = kBeams;
  h.frequency_hz = 240e3;
  h.bandwidth_hz = 15e3;
  h.pulse_length_s = 100e-6;
  h.absorption_db_per_m = 0.0625;
  h.sound_speed_m_s = 1500;
  h.source_level_db = 217;
  h.receive_width_across_deg = 1.5;
  h.receive_width_along_deg = 15;
  h.transmit_width_across_deg = 170;
  h.transmit_width_along_deg = 1.25;
  h.equivalent_beam_angle_sr = 0.0005;
  h.transducer_offset_m = {1, -2, 3};
  h.water_level_m = -4;
  return h;
}

/// Port to starboard. The time series have different lengths, and the last beam has no detection.
SonarNetcdfPing ping(int number) {
  SonarNetcdfPing p;
  p.unix_time_ns = 1714979289'123456789 + number * 33'333'333LL;
  p.latitude_deg = 48.25 + number * 1e-5;
  p.longitude_deg = -4.5;
  p.height_m = 45;
  p.heading_deg = -90;
  p.pitch_deg = 2;
  p.roll_deg = -3;
  p.waterline_below_reference_m = -5;
  p.transducer_depth_m = 5.5;
  p.waterline_to_chart_datum_m = 0.5;
  p.sound_speed_m_s = 1500;
  p.sample_interval_s = 1.0 / 16384;
  p.blanking_interval_s = 1.0 / 128;
  for (std::size_t beam = 0; beam < kBeams; ++beam) {
    p.across_angle_deg.push_back(-60 + 30.0 * double(beam));
    p.backscatter_db.emplace_back(beam * 3);
    for (std::size_t k = 0; k < beam * 3; ++k)
      p.backscatter_db[beam][k] = float(-10.0 * number - double(beam) - double(k) / 8);
    SonarDetection d;
    d.beam_angle_deg = p.across_angle_deg[beam];
    if (beam + 1 < kBeams) {
      d.found = true;
      d.two_way_travel_time_s = 0.0625 + 0.001 * number;
      d.forward_starboard_down_m = {0.5, -40 + 20.0 * double(beam), 30};
      d.latitude_deg = 48.5;
      d.longitude_deg = -4.25;
      d.backscatter_db = -33;
      d.quality = 0.25;
    }
    p.detections.push_back(d);
  }
  return p;
}

void write(const std::filesystem::path& file, int pings) {
  SonarNetcdfFile out(file, header());
  for (int k = 0; k < pings; ++k) out.add(ping(k));
  out.finish();
}

/// "group | variable | type | dimensions | units": rows of the convention that are mandatory, or that
/// apply.
constexpr const char* kTables = R"(
/Annotation | time | uint64 | time | nanoseconds since 1970-01-01 00:00:00Z
/Annotation | annotation_text | string | time | -
/Environment | frequency | float | frequency | Hz
/Environment | absorption_indicative | float | frequency | dB/m
/Environment | sound_speed_indicative | float | scalar | m/s
/Provenance | source_filenames | string | filenames | -
/Platform | transducer_function | transducer_type_t | transducer | -
/Platform | transducer_ids | string | transducer | -
/Platform | position_ids | string | position | -
/Platform | MRU_ids | string | MRU | -
/Platform | gyro_ids | string | gyro | -
/Platform | heading_ids | string | heading | -
/Platform | depth_ids | string | depth | -
/Platform | transducer_offset_x | float | transducer | m
/Platform | transducer_offset_y | float | transducer | m
/Platform | transducer_offset_z | float | transducer | m
/Platform | transducer_rotation_x | float | transducer | arc_degree
/Platform | position_offset_z | float | position | m
/Platform | MRU_offset_y | float | MRU | m
/Platform | MRU_rotation_z | float | MRU | arc_degree
/Platform | water_level | float | scalar | m
/Platform/Position/001 | time | uint64 | time | nanoseconds since 1970-01-01 00:00:00Z
/Platform/Position/001 | latitude | double | time | degrees_north
/Platform/Position/001 | longitude | double | time | degrees_east
/Platform/Position/001 | heading | float | time | degree
/Platform/Position/001 | height_above_reference_ellipsoid | float | time | m
/Platform/Attitude/001 | time | uint64 | time | nanoseconds since 1970-01-01 00:00:00Z
/Platform/Attitude/001 | pitch | float | time | arc_degree
/Platform/Attitude/001 | roll | float | time | arc_degree
/Platform/Attitude/001 | vertical_offset | float | time | m
/Platform/Attitude/001 | heading | float | time | degrees_north
/Sonar/Beam_group1 | beam | string | beam | -
/Sonar/Beam_group1 | ping_time | uint64 | ping_time | nanoseconds since 1970-01-01 00:00:00Z
/Sonar/Beam_group1 | frequency | float | frequency | Hz
/Sonar/Beam_group1 | active_MRU | int | ping_time | -
/Sonar/Beam_group1 | active_position_sensor | int | ping_time | -
/Sonar/Beam_group1 | active_gyro_sensor | int | ping_time | -
/Sonar/Beam_group1 | active_heading_sensor | int | ping_time | -
/Sonar/Beam_group1 | active_depth_sensor | int | ping_time | -
/Sonar/Beam_group1 | backscatter_r | sample_t | ping_time,beam,subbeam | dB
/Sonar/Beam_group1 | sample_count | int | ping_time,beam,subbeam | 1
/Sonar/Beam_group1 | beam_stabilisation | beam_stabilisation_t | ping_time | -
/Sonar/Beam_group1 | beam_type | beam_t | beam | -
/Sonar/Beam_group1 | beamwidth_receive_major | float | ping_time,beam | arc_degree
/Sonar/Beam_group1 | beamwidth_receive_minor | float | ping_time,beam | arc_degree
/Sonar/Beam_group1 | beamwidth_transmit_major | float | ping_time,tx_beam | arc_degree
/Sonar/Beam_group1 | beamwidth_transmit_minor | float | ping_time,tx_beam | arc_degree
/Sonar/Beam_group1 | blanking_interval | float | ping_time,beam | s
/Sonar/Beam_group1 | detected_bottom_range | float | ping_time,beam | m
/Sonar/Beam_group1 | equivalent_beam_angle | float | ping_time,beam | sr
/Sonar/Beam_group1 | non_quantitative_processing | short | ping_time | -
/Sonar/Beam_group1 | platform_heading | float | ping_time | degrees_north
/Sonar/Beam_group1 | platform_latitude | double | ping_time | degrees_north
/Sonar/Beam_group1 | platform_longitude | double | ping_time | degrees_east
/Sonar/Beam_group1 | platform_pitch | float | ping_time | arc_degree
/Sonar/Beam_group1 | platform_roll | float | ping_time | arc_degree
/Sonar/Beam_group1 | platform_vertical_offset | float | ping_time | m
/Sonar/Beam_group1 | receive_duration_effective | float | ping_time,tx_beam | s
/Sonar/Beam_group1 | receive_transducer_index | int | beam | -
/Sonar/Beam_group1 | rx_beam_rotation_phi | float | ping_time,beam | arc_degree
/Sonar/Beam_group1 | rx_beam_rotation_psi | float | ping_time,beam | arc_degree
/Sonar/Beam_group1 | rx_beam_rotation_theta | float | ping_time,beam | arc_degree
/Sonar/Beam_group1 | sample_interval | float | ping_time | s
/Sonar/Beam_group1 | sample_time_offset | float | ping_time,tx_beam | s
/Sonar/Beam_group1 | sound_speed_at_transducer | float | ping_time | m/s
/Sonar/Beam_group1 | transmit_bandwidth | float | ping_time,tx_beam | Hz
/Sonar/Beam_group1 | transmit_beam_index | int | ping_time,beam | -
/Sonar/Beam_group1 | transmit_duration_nominal | float | ping_time,tx_beam | s
/Sonar/Beam_group1 | transmit_frequency_start | float | ping_time,tx_beam | Hz
/Sonar/Beam_group1 | transmit_frequency_stop | float | ping_time,tx_beam | Hz
/Sonar/Beam_group1 | transmit_source_level | float | ping_time,tx_beam | dB
/Sonar/Beam_group1 | transmit_transducer_index | int | ping_time,tx_beam | -
/Sonar/Beam_group1 | transmit_type | transmit_t | ping_time,tx_beam | -
/Sonar/Beam_group1 | tx_beam_rotation_phi | float | ping_time,tx_beam | arc_degree
/Sonar/Beam_group1 | tx_beam_rotation_psi | float | ping_time,tx_beam | arc_degree
/Sonar/Beam_group1 | tx_beam_rotation_theta | float | ping_time,tx_beam | arc_degree
/Sonar/Beam_group1 | tx_transducer_depth | float | ping_time | m
/Sonar/Beam_group1 | waterline_to_chart_datum | float | ping_time | m
/Sonar/Beam_group1/Bathymetry | detection_latitude | double | ping_time,detection | degrees_north
/Sonar/Beam_group1/Bathymetry | detection_longitude | double | ping_time,detection | degrees_east
/Sonar/Beam_group1/Bathymetry | detection_x | float | ping_time,detection | m
/Sonar/Beam_group1/Bathymetry | detection_y | float | ping_time,detection | m
/Sonar/Beam_group1/Bathymetry | detection_z | float | ping_time,detection | m
/Sonar/Beam_group1/Bathymetry | status | byte | ping_time,detection | -
/Sonar/Beam_group1/Bathymetry | status_detail | byte | ping_time,detection | -
/Sonar/Beam_group1/Bathymetry | multiping_sequence | ubyte | ping_time | -
/Sonar/Beam_group1/Bathymetry | detection_type | detection_type_t | ping_time,detection | -
/Sonar/Beam_group1/Bathymetry | detection_beam_stabilisation | beam_stabilisation_t | ping_time | -
/Sonar/Beam_group1/Bathymetry | detection_beam_pointing_angle | float | ping_time,detection | arc_degree
/Sonar/Beam_group1/Bathymetry | detection_two_way_travel_time | float | ping_time,detection | s
/Sonar/Beam_group1/Bathymetry | detection_quality_factor | float | ping_time,detection | percent
/Sonar/Beam_group1/Bathymetry | detection_rx_transducer_index | short | ping_time,detection | -
/Sonar/Beam_group1/Bathymetry | detection_rx_beam | short | ping_time,detection | -
/Sonar/Beam_group1/Bathymetry | detection_tx_beam | short | ping_time,detection | -
/Sonar/Beam_group1/Bathymetry | detection_tx_transducer_index | short | ping_time,detection | -
/Sonar/Beam_group1/Bathymetry | detection_backscatter_r | float | ping_time,detection | dB
/Sonar/Beam_group1/Bathymetry | detection_backscatter_i | float | ping_time,detection | dB
/Sonar/Beam_group1/Bathymetry | detection_source_level_applied | float | ping_time,detection | dB
/Sonar/Beam_group1/Bathymetry | detection_mean_absorption_coefficient | float | ping_time,detection | dB/km
)";

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::size_t begin = 0;
  for (std::size_t bar = line.find(" | "); bar != std::string::npos; bar = line.find(" | ", begin)) {
    cells.push_back(line.substr(begin, bar - begin));
    begin = bar + 3;
  }
  cells.push_back(line.substr(begin));
  return cells;
}

const std::string kBeamGroup = "/Sonar/Beam_group1", kBathymetry = "/Sonar/Beam_group1/Bathymetry";

TEST(SonarNetcdf, HasEveryRowOfTheTables) {
  const TestFolder folder;
  write(folder / "line.nc", 2);
  const NetcdfReader file(folder / "line.nc");
  std::istringstream tables(kTables);
  int rows = 0;
  for (std::string line; std::getline(tables, line);) {
    if (line.empty()) continue;
    const std::vector<std::string> row = cells_of(line);
    ASSERT_EQ(row.size(), 5u) << line;
    EXPECT_EQ(file.type(row[0], row[1]), row[2]) << line;
    EXPECT_EQ(file.dimensions(row[0], row[1]), row[3]) << line;
    if (row[4] != "-") {
      EXPECT_EQ(file.text(row[0], "units", row[1].c_str()), row[4]) << line;
    }
    EXPECT_NE(file.text(row[0], "long_name", row[1].c_str()), "") << line;
    if (row[2] == "float" || row[2] == "double") {
      EXPECT_TRUE(std::isnan(file.number(row[0], "_FillValue", row[1].c_str()))) << line;
    }
    ++rows;
  }
  EXPECT_EQ(rows, 99);
}

TEST(SonarNetcdf, SaysWhatItIs) {
  const TestFolder folder;
  write(folder / "line.nc", 1);
  const NetcdfReader file(folder / "line.nc");
  EXPECT_EQ(file.text("/", "Conventions"), "SONAR-netCDF4-2.0, ACDD-1.3");
  EXPECT_EQ(file.text("/", "sonar_convention_authority"), "ICES");
  EXPECT_EQ(file.text("/", "sonar_convention_name"), "SONAR-netCDF4");
  EXPECT_EQ(file.text("/", "sonar_convention_version"), "2.0");
  EXPECT_EQ(file.text("/", "xsf_convention_version"), "0.7");
  EXPECT_EQ(file.text("/", "date_created"), "2024-05-06T07:08:09Z");
  EXPECT_EQ(file.text("/", "title"), "a line");
  EXPECT_EQ(file.text("/", "summary"), "five beams over a bed");
  EXPECT_EQ(file.text("/", "keywords"), "sonar, simulation");
  EXPECT_EQ(file.text("/Provenance", "conversion_software_name"), "tubefoot");
  EXPECT_EQ(file.text("/Provenance", "conversion_software_version"), "0.1.0");
  EXPECT_THAT(file.texts("/Provenance", "source_filenames"), ElementsAre("scene.toml", "bed.tif"));
  EXPECT_EQ(file.text("/Sonar", "sonar_type"), "multibeam echosounder");
  EXPECT_EQ(file.text(kBeamGroup, "beam_mode"), "vertical");
  for (const char* sensor :
       {"preferred_MRU", "preferred_position", "preferred_gyro", "preferred_heading", "preferred_depth"})
    EXPECT_EQ(file.number(kBeamGroup, sensor), 0) << sensor;

  for (const auto& [path, name] : {std::pair{kBeamGroup, "conversion_equation_type"},
                                   std::pair{kBathymetry, "detection_conversion_equation_type"}}) {
    nc_type type = 0;
    signed char code = 0;
    NetcdfReader::check(nc_inq_atttype(file.group(path), NC_GLOBAL, name, &type), name);
    EXPECT_EQ(file.type_name(path, type), "conversion_equation_t");
    NetcdfReader::check(nc_get_att(file.group(path), NC_GLOBAL, name, &code), name);
    EXPECT_EQ(code, 5);
  }

  using Members = std::map<std::string, int>;
  EXPECT_EQ(file.members("/Platform", "transducer_type_t"),
            (Members{{"receive_only", 0}, {"transmit_only", 1}, {"monostatic", 3}}));
  EXPECT_EQ(file.members("/Sonar", "beam_stabilisation_t"),
            (Members{{"not_stabilised", 0}, {"stabilised", 1}}));
  EXPECT_EQ(file.members("/Sonar", "beam_t"), (Members{{"single", 0},
                                                       {"split_aperture_angles", 1},
                                                       {"split_aperture_4_subbeams", 2},
                                                       {"split_aperture_3_subbeams", 3},
                                                       {"split_aperture_3_1_subbeams", 4}}));
  EXPECT_EQ(file.members("/Sonar", "transmit_t"), (Members{{"CW", 0}, {"LFM", 1}, {"HFM", 2}}));
  EXPECT_EQ(file.members(kBathymetry, "detection_type_t"),
            (Members{{"invalid", 0}, {"amplitude", 1}, {"phase", 2}, {"unknown", 127}}));
  EXPECT_EQ(file.members(kBathymetry, "seafloor_backscatter_equation_t"),
            (Members{{"type_1", 1}, {"type_2", 2}}));

  int unlimited = 0, ping = 0;
  NetcdfReader::check(nc_inq_unlimdim(file.group(kBeamGroup), &unlimited), "unlimited");
  NetcdfReader::check(nc_inq_dimid(file.group(kBeamGroup), "ping_time", &ping), "ping_time");
  EXPECT_EQ(unlimited, ping);
  for (const char* one : {"subbeam", "tx_beam", "frequency"}) EXPECT_EQ(file.length(kBeamGroup, one), 1u);
  EXPECT_EQ(file.length(kBathymetry, "detection"), kBeams);

  for (const auto& [path, name] :
       {std::pair{kBeamGroup, "ping_time"}, std::pair{std::string("/Platform/Position/001"), "time"},
        std::pair{std::string("/Platform/Attitude/001"), "time"}}) {
    EXPECT_EQ(file.text(path, "axis", name), "T");
    EXPECT_EQ(file.text(path, "calendar", name), "gregorian");
    EXPECT_EQ(file.text(path, "standard_name", name), "time");
  }
  EXPECT_EQ(file.text(kBeamGroup, "standard_name", "platform_latitude"), "Platform latitude");
  EXPECT_EQ(file.text(kBeamGroup, "standard_name", "platform_roll"), "platform_roll_angle");
  EXPECT_EQ(file.text(kBeamGroup, "flag_meanings", "non_quantitative_processing"),
            "no_non_quantitative_processing");
  EXPECT_EQ(file.number(kBeamGroup, "flag_values", "non_quantitative_processing"), 0);
  EXPECT_EQ(file.number(kBeamGroup, "valid_min", "sample_interval"), 0);
  EXPECT_EQ(file.text(kBathymetry, "crs", "detection_z"), "SCS");
}

TEST(SonarNetcdf, KeepsEveryPing) {
  const TestFolder folder;
  constexpr int pings = 37;  // more than two chunks of the file, and a rest
  write(folder / "line.nc", pings);
  const NetcdfReader file(folder / "line.nc");
  const auto times = file.times(kBeamGroup, "ping_time");
  const auto latitude = file.values(kBeamGroup, "platform_latitude");
  const auto travel = file.values(kBathymetry, "detection_two_way_travel_time");
  const auto counts = file.values(kBeamGroup, "sample_count");
  const auto lists = file.lists(kBeamGroup, "backscatter_r");
  ASSERT_EQ(times.size(), std::size_t(pings));
  EXPECT_EQ(file.times("/Platform/Position/001", "time"), times);
  EXPECT_EQ(file.times("/Platform/Attitude/001", "time"), times);
  EXPECT_EQ(file.values("/Platform/Position/001", "latitude"), latitude);
  for (int k = 0; k < pings; ++k) {
    const SonarNetcdfPing expected = ping(k);
    EXPECT_EQ(times[k], static_cast<unsigned long long>(expected.unix_time_ns));
    EXPECT_EQ(latitude[k], expected.latitude_deg);
    for (std::size_t beam = 0; beam < kBeams; ++beam) {
      EXPECT_EQ(counts[k * kBeams + beam], double(beam * 3));
      EXPECT_EQ(lists[k * kBeams + beam], expected.backscatter_db[beam]);
      const double time = expected.detections[beam].two_way_travel_time_s;
      if (beam + 1 < kBeams)
        EXPECT_EQ(travel[k * kBeams + beam], double(float(time)));
      else
        EXPECT_TRUE(std::isnan(travel[k * kBeams + beam]));
    }
  }
}

// So many lists that the writer reopens the file during the line.
TEST(SonarNetcdf, KeepsALongLine) {
  const TestFolder folder;
  constexpr int pings = 3500;
  write(folder / "line.nc", pings);
  const NetcdfReader file(folder / "line.nc");
  const auto times = file.times(kBeamGroup, "ping_time");
  const auto lists = file.lists(kBeamGroup, "backscatter_r");
  const auto latitude = file.values("/Platform/Position/001", "latitude");
  const auto travel = file.values(kBathymetry, "detection_two_way_travel_time");
  ASSERT_EQ(times.size(), std::size_t(pings));
  for (int k = 0; k < pings; ++k) {
    const SonarNetcdfPing expected = ping(k);
    ASSERT_EQ(times[k], static_cast<unsigned long long>(expected.unix_time_ns));
    ASSERT_EQ(lists[k * kBeams + 4], expected.backscatter_db[4]);
    ASSERT_EQ(latitude[k], expected.latitude_deg);
    ASSERT_EQ(travel[k * kBeams], double(float(expected.detections[0].two_way_travel_time_s)));
  }
}

TEST(SonarNetcdf, TurnsSignsAndUnitsAsTheConventionWants) {
  const TestFolder folder;
  write(folder / "line.nc", 1);
  const NetcdfReader file(folder / "line.nc");
  // Port is negative here and positive in the file.
  EXPECT_THAT(file.values(kBeamGroup, "rx_beam_rotation_phi"), ElementsAre(60, 30, 0, -30, -60));
  EXPECT_THAT(file.values(kBathymetry, "detection_beam_pointing_angle"), ElementsAre(60, 30, 0, -30, -60));
  EXPECT_THAT(file.values(kBeamGroup, "platform_heading"), ElementsAre(270));
  EXPECT_THAT(file.values("/Platform/Attitude/001", "pitch"), ElementsAre(2));
  EXPECT_THAT(file.values("/Platform/Attitude/001", "roll"), ElementsAre(-3));
  EXPECT_THAT(file.values("/Platform/Attitude/001", "vertical_offset"), ElementsAre(-1))
      << "1 m above nominal";
  EXPECT_THAT(file.values(kBeamGroup, "platform_vertical_offset"), ElementsAre(-5));
  EXPECT_THAT(file.values("/Platform", "transducer_offset_y"), ElementsAre(-2));
  EXPECT_THAT(file.codes("/Platform", "transducer_function"), ElementsAre(3));
  EXPECT_THAT(file.codes(kBathymetry, "detection_type"), ElementsAre(1, 1, 1, 1, 0));
  EXPECT_THAT(file.values(kBathymetry, "status"), ElementsAre(0, 0, 0, 0, 2));
  EXPECT_THAT(file.values(kBathymetry, "detection_rx_beam"), ElementsAre(0, 1, 2, 3, 4));
  const auto starboard = file.values(kBathymetry, "detection_y");
  EXPECT_EQ(starboard[0], -40);
  EXPECT_EQ(starboard[3], 20);
  EXPECT_TRUE(std::isnan(starboard[4]));
  EXPECT_EQ(file.values(kBathymetry, "detection_x")[0], 0.5);
  EXPECT_EQ(file.values(kBathymetry, "detection_z")[0], 30);
  EXPECT_EQ(file.values(kBathymetry, "detection_backscatter_r")[0], -33);
  EXPECT_EQ(file.values(kBathymetry, "detection_quality_factor")[0], 0.25);
  EXPECT_EQ(file.values(kBathymetry, "detection_latitude")[0], 48.5);
  EXPECT_EQ(file.values(kBathymetry, "detection_longitude")[0], -4.25);
  EXPECT_EQ(file.values(kBathymetry, "detection_mean_absorption_coefficient")[0], 62.5) << "dB/km";
  EXPECT_THAT(file.values("/Environment", "absorption_indicative"), ElementsAre(0.0625)) << "dB/m";
  EXPECT_EQ(file.values(kBeamGroup, "detected_bottom_range")[0], 1500 * 0.0625 / 2);
  EXPECT_EQ(file.values(kBeamGroup, "blanking_interval")[0], 1.0 / 128);
  EXPECT_THAT(file.values(kBeamGroup, "sample_interval"), ElementsAre(1.0 / 16384));
  EXPECT_EQ(file.values(kBeamGroup, "beamwidth_receive_minor")[0], 1.5);
  EXPECT_EQ(file.values(kBeamGroup, "beamwidth_receive_major")[0], 15);
  EXPECT_EQ(file.values(kBeamGroup, "beamwidth_transmit_major")[0], 1.25);
}

// A bow to the east: north is to port, and east is ahead.
TEST(SonarNetcdf, PutsATargetToPortAhead) {
  const glm::dvec3 point = forward_starboard_down({10, 4, -30}, 90);
  EXPECT_NEAR(point.x, 10, 1e-12);
  EXPECT_NEAR(point.y, -4, 1e-12);
  EXPECT_EQ(point.z, 30);
}

TEST(SonarNetcdf, KeepsSilenceAndALineWithoutPings) {
  const TestFolder folder;
  {
    SonarNetcdfFile out(folder / "line.nc", header());
    SonarNetcdfPing silent = ping(0);
    silent.backscatter_db[1] = {-INFINITY, -3};
    out.add(silent);
    out.finish();
  }
  EXPECT_THAT(NetcdfReader(folder / "line.nc").lists(kBeamGroup, "backscatter_r")[1],
              ElementsAre(-INFINITY, -3));
  write(folder / "empty.nc", 0);
  EXPECT_EQ(NetcdfReader(folder / "empty.nc").length(kBeamGroup, "ping_time"), 0u);
}

TEST(SonarNetcdf, EqualPingsGiveEqualFiles) {
  const TestFolder folder;
  write(folder / "a.nc", 20);
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // HDF5 stores times in seconds
  write(folder / "b.nc", 20);
  EXPECT_TRUE(bytes_of(folder / "a.nc") == bytes_of(folder / "b.nc"));
}

TEST(SonarNetcdf, IsTakenAwayUnlessItIsFinished) {
  const TestFolder folder;
  {
    SonarNetcdfFile out(folder / "line.nc", header());
    out.add(ping(0));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(SonarNetcdf, RefusesWhatDoesNotFit) {
  const TestFolder folder;
  const auto refuses = [&](auto change, const char* message) {
    SonarNetcdfFile out(folder / "line.nc", header());
    out.add(ping(0));
    SonarNetcdfPing wrong = ping(1);
    change(wrong);
    EXPECT_THAT([&] { out.add(wrong); }, ThrowsMessage<std::invalid_argument>(HasSubstr(message)));
    out.add(ping(1));
    out.finish();
    EXPECT_EQ(NetcdfReader(folder / "line.nc").length(kBeamGroup, "ping_time"), 2u);
  };
  refuses([](auto& p) { p.across_angle_deg.pop_back(); }, "ping 1: there are 4 beam angles for 5 beams");
  refuses([](auto& p) { p.backscatter_db.pop_back(); }, "ping 1: there are 4 time series for 5 beams");
  refuses([](auto& p) { p.detections.clear(); }, "ping 1: there are 0 detections for 5 beams");
  refuses([](auto& p) { p.unix_time_ns = ping(0).unix_time_ns; }, "ping 1: its time is not later than");
  refuses([](auto& p) { p.sample_interval_s = 0; }, "sample interval");
  refuses([](auto& p) { p.blanking_interval_s = NAN; }, "blanking interval");
  SonarNetcdfHeader none = header();
  none.beams = 0;
  EXPECT_THAT([&] { SonarNetcdfFile(folder / "x.nc", none); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("the number of beams is 0")));
  EXPECT_THAT([&] { SonarNetcdfFile(folder / "nowhere" / "x.nc", header()); },
              ThrowsMessage<std::runtime_error>(HasSubstr("No such file")));
}

/// Writes pings of 400 kB until the disk is full. The program must then end normally.
[[noreturn]] void fill_disk(const std::filesystem::path& folder, std::size_t samples) {
  try {
    SonarNetcdfFile out(folder / "line.nc", header());
    SonarNetcdfPing p = ping(0);
    for (auto& series : p.backscatter_db) series.assign(samples, -20.f);
    for (int k = 0; k < 1000; ++k, ++p.unix_time_ns) out.add(p);
    out.finish();
    std::fputs("it all went in", stderr);
  } catch (const std::runtime_error& error) {
    std::fputs(error.what(), stderr);
  }
  std::fputs(std::filesystem::is_empty(folder) ? " and nothing is left" : " and something is left", stderr);
  umount2(folder.c_str(), MNT_DETACH);
  std::filesystem::remove_all(folder);
  std::exit(0);
}

TEST(SonarNetcdfDeathTest, SurvivesAFullDisk) {
  if (!full_disk::available()) GTEST_SKIP() << "no private file system can be mounted here";
  testing::FLAGS_gtest_death_test_style = "threadsafe";  // exit() joins threads of libraries
  // From too small for an empty file to hundreds of pings, with long lists and short ones.
  for (const std::size_t megabytes : {1, 5, 7, 10, 17})
    for (const std::size_t samples : {20000, 50}) {
      if (samples == 50 && megabytes > 5) continue;  // all pings would fit
      const TestFolder folder;
      EXPECT_EXIT(
          {
            full_disk::mount(folder.path(), megabytes << 20);
            fill_disk(folder.path(), samples);
          },
          testing::ExitedWithCode(0), "No space left on device and nothing is left")
          << megabytes << " MiB, " << samples << " samples";
    }
}

TEST(SonarNetcdfDeathTest, SurvivesAFileSizeLimit) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";  // exit() joins threads of libraries
  for (const std::size_t megabytes : {5, 12}) {
    const TestFolder folder;
    EXPECT_EXIT(
        {
          const samples::FullDisk limit(megabytes << 20);
          fill_disk(folder.path(), 20000);
        },
        testing::ExitedWithCode(0), "File too large and nothing is left")
        << megabytes << " MiB";
  }
}

// netCDF4-python reads the file as the users of GLOBE, PyAT and xarray do (Debian: python3-netcdf4).
TEST(SonarNetcdf, AnotherClientReadsIt) {
  if (std::system("/usr/bin/python3 -c 'import netCDF4' 2>/dev/null") != 0)
    GTEST_SKIP() << "python3-netcdf4 is not installed";
  const TestFolder folder;
  write(folder / "line.nc", 3);
  std::ofstream(folder / "read.py") << R"(
import sys, netCDF4, numpy as np
f = netCDF4.Dataset(sys.argv[1])
assert f.data_model == "NETCDF4"
g = f["/Sonar/Beam_group1"]
b = g["Bathymetry"]
assert int(g.conversion_equation_type) == 5
r = g["backscatter_r"][:]
assert r.shape == (3, 5, 1), r.shape
assert len(r[2, 4, 0]) == 12 and r[2, 4, 0][8] == -25, r[2, 4, 0]
assert [int(n) for n in np.ravel(g["sample_count"][1])] == [0, 3, 6, 9, 12]
assert b["detection_z"].dimensions == ("ping_time", "detection")
assert b["detection_z"][1].count() == 5 and np.isnan(np.ma.filled(b["detection_z"][1], np.nan)[4]) or np.ma.getmaskarray(b["detection_z"][1])[4]
when = netCDF4.num2date(g["ping_time"][0] / 1e9, "seconds since 1970-01-01")
assert when.year == 2024 and when.month == 5 and when.day == 6 and when.second == 9, when
assert g["beam_type"].datatype.name == "beam_t"
)";
  EXPECT_EQ(
      std::system(("/usr/bin/python3 " + (folder / "read.py").string() + " " + (folder / "line.nc").string())
                      .c_str()),
      0);
}

}  // namespace
}  // namespace tubefoot
