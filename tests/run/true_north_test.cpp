// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the files of a run as other programs read them. These programs add sounding offsets along the
// heading to the sonar position, add the sonar depth, and must reach the soundings. The maps have a north
// far from true north.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/UTMUPS.hpp>
#include <cmath>
#include <map>

#include "fixtures/camera_file_reader.hpp"
#include "fixtures/csv_rows.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/packet_reader.hpp"
#include "fixtures/program.hpp"
#include "geometry/numbers/scalars.hpp"
#include "scene/rasters/georeference.hpp"

namespace tubefoot {
namespace {

using samples::PacketReader;
constexpr double sound_speed_m_s = 1500;

/// A map, a position on it, and the angle of a direction from true north, by the law of the map.
struct Map {
  const char *name, *crs;  ///< no CRS: tangent to the Earth
  double easting, northing;
  double (*true_heading_deg)(double map_heading_deg, double down_deg, double longitude_deg,
                             double latitude_deg);
  /// scale is correct to 3 parts in 10^4 there, and the plane is level
  bool true_to_scale;
  /// of the scene from the origin of the frame; above a height of the frame
  double away_east_m = 0, rise_m = 0;
};

double on_utm(double heading_deg, double, double longitude_deg, double latitude_deg) {
  int zone = 0;
  bool north = false;
  double x = 0, y = 0, gamma_deg = 0, k = 0;
  GeographicLib::UTMUPS::Forward(latitude_deg, longitude_deg, zone, north, x, y, gamma_deg, k, 33);
  return heading_deg + gamma_deg;
}

double on_conic(double heading_deg, double, double longitude_deg, double) {
  return heading_deg + (longitude_deg + 95) * std::sin(70 * degree);
}

/// The formulas of the map are those of a sphere. North and east have different scales, by the radii of
/// curvature. Only the four cardinal directions are exact.
double on_web_mercator(double heading_deg, double, double, double latitude_deg) {
  const double f = 1 / 298.257223563, e2 = f * (2 - f), s = std::sin(latitude_deg * degree);
  const double north_over_east = (1 - e2) / (1 - e2 * s * s);
  return std::atan2(std::sin(heading_deg * degree), std::cos(heading_deg * degree) * north_over_east) /
         degree;
}

/// North turns and the plane tilts with the distance from its tangent point.
double on_tangent(double heading_deg, double down_deg, double longitude_deg, double latitude_deg) {
  const GeographicLib::LocalCartesian plane(70, 18, 4);
  double x = 0, y = 0, z = 0;
  std::vector<double> axes(9);  // at the position, in the frame, as columns
  plane.Forward(latitude_deg, longitude_deg, 0, x, y, z, axes);
  const double level = std::cos(down_deg * degree), up = -std::sin(down_deg * degree),
               east = level * std::sin(heading_deg * degree), north = level * std::cos(heading_deg * degree);
  return std::atan2(axes[0] * east + axes[3] * north + axes[6] * up,
                    axes[1] * east + axes[4] * north + axes[7] * up) /
         degree;
}

std::vector<Map> maps() {
  const char* const conic = "+proj=lcc +lat_1=70 +lat_0=70 +lon_0=-95 +datum=WGS84 +units=m";
  const glm::dvec3 there = LocalFrame::projected(conic, 0, 0, 0, {}).from_lat_lon(70, -60, 0, {});
  return {{"the edge of a UTM zone", "EPSG:32633", 614000, 7770000, on_utm, true},
          {"a conic map", conic, there.x, there.y, on_conic, true},
          {"Web Mercator", "EPSG:3857", 1.2e6, 8.4e6, on_web_mercator, false},
          // 6396.97 km: the radius of curvature along the parallel of 70 degrees.
          {"a tangent plane, 4 km away", "", 0, 0, on_tangent, false, 4000, 4000.0 * 4000 / (2 * 6396970)}};
}

/// A seabed 30 m below height 0. Two multibeams, a sidescan, a DIDSON and an ARIS sink from 5.5 to 8.5 m
/// over 20 m.
constexpr double map_heading_deg = 36.86989764584402;
std::string scene_on(const Map& map) {
  return fmt::format(R"(
[georeference]
{}
origin_height_m = 4
[run]
start_utc = "2024-06-01T12:00:00Z"
[water]
sound_speed_m_s = {}
[[materials]]
name = "bed"
[[terrain]]
kind = "flat"
width_m = 400
length_m = 400
centre_m = [{}, 0, -34]
[trajectory]
kind = "line"
start_m = [{}, -8, -9.5]
end_m = [{}, 8, -12.5]
speed_m_s = 5
[[sensors]]
name = "reson"
preset = "reson-8101"
range_min_m = 1
range_max_m = 61
samples = 1200
pings = 3
ping_interval_s = 1.9
[[sensors]]
name = "fan"
kind = "multibeam"
frequency_khz = 300
beams = 31
swath_deg = 120
beam_across_deg = 4
along_track_deg = 2
range_min_m = 1
range_max_m = 61
samples = 1200
pings = 3
ping_interval_s = 1.9
[[sensors]]
name = "side"
kind = "sidescan"
samples = 50
pings = 3
ping_interval_s = 1.9
[[sensors]]
name = "didson"
kind = "didson"
yaw_deg = 25
tilt_deg = 20
window_start_m = 2.94
[[sensors]]
name = "aris"
preset = "aris-1800"
tilt_deg = 20
)",
                     *map.crs == '\0' ? "origin_lat_lon_deg = [70, 18]"
                                      : fmt::format("crs = \"{}\"\norigin_crs = [{:.6f}, {:.6f}]", map.crs,
                                                    map.easting, map.northing),
                     sound_speed_m_s, map.away_east_m, map.away_east_m - 6, map.away_east_m + 6);
}

/// Position of a sounding in a line of the soundings table.
struct Place {
  double longitude_deg = 0, latitude_deg = 0, height_m = 0;
};
using Soundings = std::map<std::pair<std::size_t, std::size_t>, Place>;  // by ping and beam

Soundings soundings_in(const std::filesystem::path& file) {
  Soundings soundings;
  for (const auto& row : csv_rows(file)) {
    const auto number = [&](const char* name) { return std::stod(row.at(name)); };
    soundings[{std::size_t(number("ping")), std::size_t(number("beam"))}] = {
        number("longitude_deg_east"), number("latitude_deg_north"), number("height_m_up_positive")};
  }
  return soundings;
}

double metres_between(const Place& a, double longitude_deg, double latitude_deg) {
  double distance_m = 0;
  GeographicLib::Geodesic::WGS84().Inverse(a.latitude_deg, a.longitude_deg, latitude_deg, longitude_deg,
                                           distance_m);
  return distance_m;
}

/// Method of a reader: along the heading and to starboard on the ellipsoid, then down.
Place from_heading(const Place& sonar, double heading_deg, double ahead_m, double starboard_m,
                   double depth_m) {
  Place place;
  GeographicLib::Geodesic::WGS84().Direct(
      sonar.latitude_deg, sonar.longitude_deg, heading_deg + std::atan2(starboard_m, ahead_m) / degree,
      std::hypot(ahead_m, starboard_m), place.latitude_deg, place.longitude_deg);
  place.height_m = -depth_m;
  return place;
}

void expect_heading(double found_deg, const Map& map, const Place& at, double tolerance_deg, const char* what,
                    double mounted_deg = 0, double down_deg = 0) {
  const double wanted =
      map.true_heading_deg(map_heading_deg + mounted_deg, down_deg, at.longitude_deg, at.latitude_deg);
  EXPECT_NEAR(std::remainder(found_deg - wanted, 360), 0, tolerance_deg) << what << " on " << map.name;
}

class OnTheMaps : public testing::TestWithParam<std::size_t> {
 protected:
  void SetUp() override {
    map = maps().at(GetParam());
    SCOPED_TRACE(map.name);
    folder.write("scene.toml", scene_on(map));
    const Outcome outcome =
        run_program({"run", (folder / "scene.toml").string(), "-o", (folder / "out").string()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  Soundings soundings(const char* sensor) const {
    const Soundings all = soundings_in(folder / fmt::format("out/{}-soundings.csv", sensor));
    EXPECT_GE(all.size(), 50u);
    return all;
  }

  void check_sonar_netcdf();
  void check_gsf();
  void check_xtf();
  void check_other_files();

  TestFolder folder;
  Map map{};
};

void OnTheMaps::check_sonar_netcdf() {
  for (const char* sensor : {"reson", "fan"}) {
    const NetcdfReader file(folder / fmt::format("out/{}-sonar.nc", sensor));
    const auto ping_values = [&](const char* name) { return file.values("/Sonar/Beam_group1", name); };
    const auto beam_values = [&](const char* name) {
      return file.values("/Sonar/Beam_group1/Bathymetry", name);
    };
    const auto longitude = ping_values("platform_longitude"), latitude = ping_values("platform_latitude"),
               heading = ping_values("platform_heading"), offset = ping_values("platform_vertical_offset");
    const auto x = beam_values("detection_x"), y = beam_values("detection_y"), z = beam_values("detection_z"),
               to_longitude = beam_values("detection_longitude"),
               to_latitude = beam_values("detection_latitude");
    const std::size_t beams = x.size() / heading.size();
    const auto heading_again = file.values("/Platform/Position/001", "heading");
    for (std::size_t ping = 0; ping < heading.size(); ++ping) {
      expect_heading(heading[ping], map, {longitude[ping], latitude[ping], 0}, 1e-5, sensor);
      EXPECT_EQ(heading_again.at(ping), heading[ping]);
    }
    for (const auto& [key, place] : soundings(sensor)) {
      const auto [ping, beam] = key;
      const std::size_t k = ping * beams + beam;
      const Place found =
          from_heading({longitude[ping], latitude[ping], 0}, heading[ping], x[k], y[k], z[k] - offset[ping]);
      EXPECT_LT(metres_between(found, to_longitude[k], to_latitude[k]), 1e-3) << ping << " " << beam;
      EXPECT_LT(metres_between(found, place.longitude_deg, place.latitude_deg), 1e-3);
      EXPECT_NEAR(found.height_m, place.height_m, 1e-3);
    }
  }
}

void OnTheMaps::check_gsf() {
  for (const char* sensor : {"reson", "fan"}) {
    const Soundings truth = soundings(sensor);
    PacketReader file(samples::file_content(folder / fmt::format("out/{}.gsf", sensor)), true);
    std::size_t ping = 0, parameters = 0, own_subrecords = 0;
    for (std::size_t at = 0; at < file.size(); at += 8 + file.u32(at)) {
      PacketReader record(file.part(at + 8, file.u32(at)), true);
      if (file.u32(at + 4) == 4) {
        EXPECT_EQ(ping, 0u) << "before the first ping";
        parameters = record.u16(8);
      }
      if (file.u32(at + 4) != 2) continue;
      const Place sonar{record.i32(8) / 1e7, record.i32(12) / 1e7, record.i32(42) / 1e3};
      const double heading_deg = record.u16(30) / 100.0;
      expect_heading(heading_deg, map, sonar, 0.006, "heading");
      expect_heading(record.u16(38) / 100.0, map, sonar, 0.006, "course");
      EXPECT_NEAR(record.i32(26) / 100.0, -sonar.height_m, 0.006)
          << "depth of the sonar, which is in the depths";
      const auto beams = static_cast<std::size_t>(record.i16(16));
      std::map<unsigned, std::vector<double>> arrays;
      for (std::size_t place = 56; place + 4 < record.size();) {
        const unsigned id = record.u8(place);
        const std::size_t size = record.u32(place) & 0xFFFFFF;
        place += 4;
        own_subrecords += id == 122;
        for (std::size_t beam = 0; id >= 1 && id <= 3 && beam < beams; ++beam)
          arrays[id].push_back(record.i32(place + 4 * beam) / 1e3);
        place += size;
      }
      for (std::size_t beam = 0; beam < beams; ++beam) {
        const auto place = truth.find({ping, beam});
        if (place == truth.end()) continue;
        const Place found =
            from_heading(sonar, heading_deg, arrays[3].at(beam), arrays[2].at(beam), arrays[1].at(beam));
        EXPECT_LT(metres_between(found, place->second.longitude_deg, place->second.latitude_deg), 0.02)
            << ping << " " << beam;
        EXPECT_NEAR(found.height_m, place->second.height_m, 1e-3);
      }
      ++ping;
    }
    EXPECT_EQ(ping, 3u);
    EXPECT_GE(parameters, 10u);
    EXPECT_EQ(own_subrecords, sensor == std::string("reson") ? 3u : 0u);
  }
}

// Method of MB-System: the offset across the track comes from range and angle. The depth adds OffsetZ of
// the channel, less heave. Angles and times do not depend on the scale of the map.
void OnTheMaps::check_xtf() {
  for (const char* sensor : {"reson", "fan"}) {
    const Soundings truth = soundings(sensor);
    PacketReader file(samples::file_content(folder / fmt::format("out/{}.xtf", sensor)), false);
    const double offset_m = file.f32(256 + 56);
    EXPECT_EQ(file.f32(240), offset_m) << "no lever between motion sensor and transducer";
    EXPECT_NEAR(offset_m, 7 - map.rise_m, 0.1) << "half way between 5.5 and 8.5 m";
    std::size_t ping = 0, compared = 0;
    double attitude_heave_m = 0, attitude_deg = 0;
    for (std::size_t at = 1024; at < file.size(); at += file.u32(at + 10)) {
      PacketReader packet(file.part(at, file.u32(at + 10)), false);
      if (packet.u8(2) == 3) {
        attitude_deg = packet.f32(50);
        attitude_heave_m = packet.f32(38);
      }
      if (packet.u8(2) != 2 && packet.u8(2) != 28) continue;
      const Place sonar{packet.f64(168), packet.f64(160), 0};
      expect_heading(packet.f32(212), map, sonar, 1e-5, "sensor");
      EXPECT_EQ(packet.f32(124), packet.f32(212));
      EXPECT_EQ(attitude_deg, packet.f32(212));
      EXPECT_EQ(packet.f32(216), static_cast<float>(attitude_heave_m));
      EXPECT_NEAR(packet.f32(192), offset_m - attitude_heave_m, 1e-5);
      const auto compare = [&](std::size_t beam, double time_s, double angle_deg) {
        const auto place = truth.find({ping, beam});
        if (place == truth.end() || !map.true_to_scale) return;
        const double range_m = time_s * sound_speed_m_s / 2;
        const Place found =
            from_heading(sonar, packet.f32(212), 0, range_m * std::sin(angle_deg * degree),
                         range_m * std::cos(angle_deg * degree) - attitude_heave_m + offset_m);
        EXPECT_LT(metres_between(found, place->second.longitude_deg, place->second.latitude_deg), 0.04)
            << ping << " " << beam;
        EXPECT_NEAR(found.height_m, place->second.height_m, 0.02);
        ++compared;
      };
      if (packet.u8(2) == 28) {
        for (std::size_t k = 0; k < packet.u16(4); ++k)
          compare(packet.u32(256 + 64 * k), packet.f64(256 + 64 * k + 16), packet.f64(256 + 64 * k + 32));
      } else {
        PacketReader reson(packet.part(256, packet.size() - 256), true);
        for (std::size_t beam = 0; beam < 101; ++beam)
          compare(beam, 0.25 * reson.u16(68 + 2 * beam) / reson.u16(30), -75 + 1.5 * double(beam));
      }
      ++ping;
    }
    EXPECT_EQ(ping, 3u);
    EXPECT_EQ(compared, map.true_to_scale ? truth.size() : 0);
  }
}

void OnTheMaps::check_other_files() {
  PacketReader file(samples::file_content(folder / "out/side.xtf"), false);
  std::size_t pings = 0;
  double attitude_deg = 0;
  for (std::size_t at = 1024; at < file.size(); at += file.u32(at + 10)) {
    PacketReader packet(file.part(at, file.u32(at + 10)), false);
    if (packet.u8(2) == 3) attitude_deg = packet.f32(50);
    if (packet.u8(2) != 0) continue;
    expect_heading(packet.f32(212), map, {packet.f64(168), packet.f64(160), 0}, 1e-5, "sidescan");
    EXPECT_EQ(packet.f32(124), packet.f32(212));
    EXPECT_EQ(attitude_deg, packet.f32(212));
    EXPECT_NEAR(packet.f32(192), 5.5 + 3 * 1.9 * double(pings) / 4.1 - map.rise_m, 0.3) << pings;
    ++pings;
  }
  EXPECT_EQ(pings, 3u);
  const double tolerance_m = map.rise_m > 0 ? 0.01 : 1e-5;  // 6 m farther or nearer
  const camera_file::Reader ddf(folder / "out/didson.ddf"), aris(folder / "out/aris.aris");
  for (const camera_file::Reader* camera : {&ddf, &aris}) {
    const Place at{camera->number(0, "Longitude"), camera->number(0, "Latitude"), 0};
    expect_heading(camera->number(0, "Heading"), map, at, 1e-5, "camera's platform");
    expect_heading(camera->number(0, "CompassHeading"), map, at, 1e-5, "camera", camera == &ddf ? 25 : 0, 20);
    EXPECT_NEAR(camera->number(0, "Depth"), 5.5 - map.rise_m, tolerance_m) << "origin_height_m counts";
  }
  for (const char* sensor : {"reson", "side", "didson"}) {
    const auto echoes = [&](const char* name) {
      return NetcdfReader(folder / "out/echoes.nc").values(fmt::format("/{}", sensor), name);
    };
    EXPECT_NEAR(echoes("sensor_height")[0], -5.5 + map.rise_m, tolerance_m);
    const double mounted_deg = sensor == std::string("didson") ? 25 : 0;
    const auto heading = echoes("sensor_true_heading"), of_frame = echoes("sensor_heading"),
               longitude = echoes("sensor_longitude"), latitude = echoes("sensor_latitude");
    for (std::size_t ping = 0; ping < heading.size(); ++ping) {
      expect_heading(heading[ping], map, {longitude[ping], latitude[ping], 0}, 1e-7, "echoes", mounted_deg,
                     mounted_deg > 0 ? 20 : 0);
      EXPECT_NEAR(of_frame[ping], map_heading_deg + mounted_deg, 1e-9);
    }
    EXPECT_LT(
        metres_between({ddf.number(0, "Longitude"), ddf.number(0, "Latitude"), 0}, longitude[0], latitude[0]),
        1e-6);
  }
}

// One run of the program for all of its files.
TEST_P(OnTheMaps, SoundingsFollowFromPositionAndHeadingInEveryFile) {
  check_sonar_netcdf();
  check_gsf();
  check_xtf();
  check_other_files();
}

INSTANTIATE_TEST_SUITE_P(FilesOfARun, OnTheMaps, testing::Values(0, 1, 2, 3));

}  // namespace
}  // namespace tubefoot
