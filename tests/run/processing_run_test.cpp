// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the files of sonars whose software assumes another configuration than the true one. The seabed is
// level, so that each error has a closed form. Soundings files have positions to 0.1 mm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>

#include "fixtures/multibeam_runs.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/packet_reader.hpp"
#include "geometry/numbers/scalars.hpp"

namespace tubefoot {
namespace {

using namespace multibeam_for_tests;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

constexpr double file_rounding_m = 1.5e-4, bed_m = -20, boat_m = -2, below_boat_m = boat_m - bed_m,
                 still_m_s = 1500;

/// A line at 37 degrees, so that no axis of the carrier is one of the frame.
const std::string oblique_course =
    "[trajectory]\nkind = \"line\"\nstart_m = [-6.018150231520483, -7.986355100472928, -2]\n"
    "end_m = [6.018150231520483, 7.986355100472928, -2]\nspeed_m_s = 4\n";
constexpr double course_deg = 37, boat_m_s = 4;

std::string processed_fan(const std::string& more = {}) {
  return "[[sensors]]\nname = \"sonar\"\nkind = \"multibeam\"\nbeams = 21\nswath_deg = 120\nbeam_across_deg "
         "= "
         "1\nalong_track_deg = 1\nrange_min_m = 1\nrange_max_m = 51\nsamples = 5000\nfirst_ping_s = 1\npings "
         "= "
         "3\nping_interval_s = 0.5\n" +
         more;
}

std::string level_scene(const std::string& sensors, const std::string& processing,
                        const std::string& water = still_water()) {
  return "[georeference]\norigin_lat_lon_deg = [59.0, 10.0]\n" + water + lambert_material("bed", -27) +
         flat_terrain(300, 300, "centre_m = [0, 0, -20]\n") + oblique_course + sensors + processing;
}

/// The soundings of a run in a folder of its own.
std::vector<CsvSounding> soundings_of(const std::string& scene,
                                      const std::function<void(const TestFolder&)>& before = {}) {
  const TestFolder folder;
  if (before) before(folder);
  run(folder, scene);
  return soundings_in(folder / "out/sonar-soundings.csv");
}

struct FromSonar {
  double starboard, forward, up;
};
/// The vector to a sounding from the true position of the sonar, on axes along and across the oblique_course.
FromSonar from_sonar(const CsvSounding& s) {
  const double time_s = 1 + 0.5 * double(s.ping), along_m = boat_m_s * time_s - 10;
  const double east = s.east - along_m * std::sin(course_deg * degree),
               north = s.north - along_m * std::cos(course_deg * degree);
  return {east * std::cos(course_deg * degree) - north * std::sin(course_deg * degree),
          east * std::sin(course_deg * degree) + north * std::cos(course_deg * degree), s.up - boat_m};
}

/// Calls `check` with each pair of soundings of a true and of an assumed configuration.
void expect_pairs(const std::string& processing,
                  const std::function<void(FromSonar, FromSonar, double)>& check,
                  const std::string& water = still_water(), const std::string& sensor = processed_fan(),
                  const std::function<void(const TestFolder&)>& before = {}) {
  const auto truth = soundings_of(level_scene(processed_fan(), "", water)),
             assumed = soundings_of(level_scene(sensor, processing, water), before);
  ASSERT_EQ(truth.size(), 63u);
  ASSERT_EQ(assumed.size(), truth.size());
  for (std::size_t k = 0; k < truth.size(); ++k) {
    SCOPED_TRACE(testing::Message() << "ping " << truth[k].ping << " beam " << truth[k].beam);
    check(from_sonar(truth[k]), from_sonar(assumed[k]), 1 + 0.5 * double(truth[k].ping));
  }
}

TEST(ProcessingRun, RollBias_TiltsTheSeabedAcrossTheTrack) {
  const auto tilted = [](FromSonar t, FromSonar a, double) {
    const double sine = std::sin(2 * degree), cosine = std::cos(2 * degree);
    EXPECT_NEAR(a.starboard, t.starboard * cosine + t.up * sine, file_rounding_m);
    EXPECT_NEAR(a.up, t.up * cosine - t.starboard * sine, file_rounding_m);
    EXPECT_NEAR(a.forward, t.forward, file_rounding_m);
    // The seabed at depth H has become the line up = -H / cos 2 - starboard tan 2.
    EXPECT_NEAR(a.up + std::tan(2 * degree) * a.starboard, t.up / cosine, 2 * file_rounding_m);
    EXPECT_NEAR(t.up, -below_boat_m, 0.02);
  };
  expect_pairs("[processing]\nattitude_bias_deg = [0, 0, 2]\n", tilted);
  // A wrong mounting of the sonar on a level carrier has the same effect.
  expect_pairs("[sensors.processing]\nroll_deg = 2\n", tilted);
}

TEST(ProcessingRun, PitchBias_DisplacesAlongTheTrack) {
  const auto displaced = [](FromSonar t, FromSonar a, double) {
    EXPECT_NEAR(a.forward - t.forward, -a.up * std::tan(3 * degree), 2 * file_rounding_m);
    EXPECT_NEAR(a.starboard, t.starboard, file_rounding_m);
  };
  expect_pairs("[processing]\nattitude_bias_deg = [0, 3, 0]\n", displaced);
  expect_pairs("[sensors.processing]\ntilt_deg = -3\n", displaced);
}

TEST(ProcessingRun, HeadingBias_TurnsTheSwath) {
  const auto turned = [](FromSonar t, FromSonar a, double) {
    EXPECT_NEAR(a.starboard, t.starboard * std::cos(5 * degree), file_rounding_m);
    EXPECT_NEAR(a.forward, -t.starboard * std::sin(5 * degree), 2 * file_rounding_m);
    EXPECT_NEAR(a.up, t.up, file_rounding_m);
  };
  expect_pairs("[processing]\nattitude_bias_deg = [5, 0, 0]\n", turned);
  expect_pairs("[sensors.processing]\nyaw_deg = 5\n", turned);
}

TEST(ProcessingRun, Latency_DisplacesBySpeedTimesLatency) {
  for (const double latency_s : {0.25, -0.5})
    expect_pairs(fmt::format("[processing]\nlatency_s = {}\nattitude_latency_s = 0.7\n", latency_s),
                 [&](FromSonar t, FromSonar a, double) {
                   EXPECT_NEAR(a.forward, t.forward - boat_m_s * latency_s, file_rounding_m);
                   EXPECT_NEAR(a.starboard, t.starboard, file_rounding_m);
                   EXPECT_NEAR(a.up, t.up, file_rounding_m);
                 });
}

TEST(ProcessingRun, AttitudeLatency_TakesTheRollOfEarlier) {
  const std::string track = "[trajectory]\nkind = \"waypoints\"\nfile = \"t.csv\"\n";
  const auto rolling = [&](const std::string& processing) {
    return soundings_of(
        replaced(level_scene(processed_fan(), processing), oblique_course, track),
        [](const TestFolder& folder) {
          // The roll increases by 4 degrees per second.
          folder.write("t.csv",
                       "time_s,east_m,north_m,up_m,heading_deg,roll_deg\n0,0,0,-2,0,0\n5,0,0.001,-2,0,20\n");
        });
  };
  const auto truth = rolling(""), late = rolling("[processing]\nattitude_latency_s = 0.25\n");
  ASSERT_EQ(late.size(), truth.size());
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double sine = std::sin(1 * degree), cosine = std::cos(1 * degree);  // recorded: 1 degree less
    EXPECT_NEAR(late[k].east, truth[k].east * cosine - (truth[k].up - boat_m) * sine, 2 * file_rounding_m);
    EXPECT_NEAR(late[k].up - boat_m, (truth[k].up - boat_m) * cosine + truth[k].east * sine,
                2 * file_rounding_m);
  }
}

// The profile moves with the water level, so that its error is the same in stratified water.
TEST(ProcessingRun, Tide_AddsToHeights) {
  const std::string gradient =
      "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = -1\nprofile_bottom_m = 40\n";
  for (const std::string& water : {still_water(), gradient})
    expect_pairs(
        "[processing]\ntide_m = 0.25\ntide_file = \"tide.csv\"\n",
        [](FromSonar t, FromSonar a, double time_s) {
          EXPECT_NEAR(a.up, t.up + 0.25 + (time_s - 1) * 0.4, file_rounding_m);
          EXPECT_NEAR(a.starboard, t.starboard, file_rounding_m);
          EXPECT_NEAR(a.forward, t.forward, file_rounding_m);
        },
        water, processed_fan(),
        [](const TestFolder& folder) { folder.write("tide.csv", "tide_m,time_s\n0,1\n0.2,1.5\n0.8,3\n"); });
}

TEST(ProcessingRun, LeverArmAndPositionErrors_Displace) {
  expect_pairs("[sensors.processing]\nlever_arm_m = [0.5, -0.75, 0.125]\n",
               [](FromSonar t, FromSonar a, double) {
                 EXPECT_NEAR(a.starboard, t.starboard + 0.5, file_rounding_m);
                 EXPECT_NEAR(a.forward, t.forward - 0.75, file_rounding_m);
                 EXPECT_NEAR(a.up, t.up + 0.125, file_rounding_m);
               });
  expect_pairs("[processing]\nposition_bias_m = [0.3, 0.4, -0.1]\nposition_drift_m_per_hour = [0, 0, 720]\n",
               [](FromSonar t, FromSonar a, double time_s) {
                 const double sine = std::sin(course_deg * degree), cosine = std::cos(course_deg * degree);
                 EXPECT_NEAR(a.starboard, t.starboard + 0.3 * cosine - 0.4 * sine, file_rounding_m);
                 EXPECT_NEAR(a.forward, t.forward + 0.3 * sine + 0.4 * cosine, file_rounding_m);
                 EXPECT_NEAR(a.up, t.up - 0.1 + 0.2 * time_s, file_rounding_m);
               });
}

TEST(ProcessingRun, SoundSpeed_ScalesRanges) {
  expect_pairs("[processing.water]\nsound_speed_m_s = 1470\n", [](FromSonar t, FromSonar a, double) {
    EXPECT_NEAR(a.starboard, t.starboard * 0.98, file_rounding_m);
    EXPECT_NEAR(a.up, t.up * 0.98, file_rounding_m);
  });
}

TEST(ProcessingRun, SoundSpeedAtTheTransducer_ChangesAngles) {
  const TestFolder folder;
  for (const double assumed : {1450.0, 1530.0}) {
    SCOPED_TRACE(assumed);
    const auto soundings = soundings_of(level_scene(
        processed_fan(), fmt::format("[processing]\nsound_speed_at_transducer_m_s = {}\n", assumed)));
    ASSERT_EQ(soundings.size(), 63u);
    for (const CsvSounding& s : soundings) {
      const double truth = (-60 + 6 * double(s.beam)) * degree;
      EXPECT_NEAR(s.angle_deg, std::asin(std::sin(truth) * assumed / still_m_s) / degree, 1e-9);
      // The range stays, and the sounding lies at the recorded angle.
      EXPECT_NEAR(from_sonar(s).starboard, s.range * std::sin(s.angle_deg * degree), 2 * file_rounding_m);
    }
  }
  // The sine of the outermost recorded angles would be sin 60 x 1690 / 1450 = 1.009.
  folder.write("scene.toml",
               level_scene(processed_fan(), "[processing]\nsound_speed_at_transducer_m_s = 1690\n",
                           "[water]\nsound_speed_m_s = 1450\n"));
  const Outcome outcome =
      run_program({"run", (folder / "scene.toml").string(), "-o", (folder / "out").string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr("2 beams of sensor 'sonar' have no recorded angle"), HasSubstr("scene.toml")));
  const auto kept = soundings_in(folder / "out/sonar-soundings.csv");
  EXPECT_EQ(kept.size(), 3 * 19u);
  for (const CsvSounding& s : kept) EXPECT_TRUE(s.beam > 0 && s.beam < 20);
}

/// A point on a ray in depth and horizontal distance.
struct RayEnd {
  double depth_m = 0, across_m = 0;
};

/// Traces a ray by fourth-order Runge-Kutta steps in time through a profile that is linear between points.
/// The angle counts from straight down.
RayEnd traced(const std::vector<std::pair<double, double>>& profile, double from_m, double angle_rad,
              double time_s) {
  const auto speed = [&](double depth_m, double& gradient) {
    for (std::size_t k = 1; k < profile.size(); ++k)
      if (depth_m < profile[k].first) {
        gradient = (profile[k].second - profile[k - 1].second) / (profile[k].first - profile[k - 1].first);
        return profile[k - 1].second + gradient * (depth_m - profile[k - 1].first);
      }
    gradient = 0;
    return profile.back().second;
  };
  struct State {
    double depth, across, angle;
  };
  const auto rate = [&](const State& s) {
    double gradient = 0;
    const double v = speed(s.depth, gradient);
    return State{v * std::cos(s.angle), v * std::sin(s.angle), gradient * std::sin(s.angle)};
  };
  const auto moved = [](const State& s, const State& r, double h) {
    return State{s.depth + h * r.depth, s.across + h * r.across, s.angle + h * r.angle};
  };
  constexpr int steps = 20000;
  const double h = time_s / steps;
  State s{from_m, 0, angle_rad};
  for (int k = 0; k < steps; ++k) {
    const State a = rate(s), b = rate(moved(s, a, h / 2)), d = rate(moved(s, b, h / 2)),
                e = rate(moved(s, d, h));
    s = moved(
        s,
        {a.depth + 2 * b.depth + 2 * d.depth + e.depth, a.across + 2 * b.across + 2 * d.across + e.across,
         a.angle + 2 * b.angle + 2 * d.angle + e.angle},
        h / 6);
  }
  return {s.depth, s.across};
}

std::string table_of(const std::vector<std::pair<double, double>>& profile) {
  std::string text = "depth_m,sound_speed_m_s\n";
  for (const auto& [depth, speed] : profile) text += fmt::format("{},{}\n", depth, speed);
  return text;
}

TEST(ProcessingRun, Profile_DeterminesTheRefractionArtefact) {
  const std::vector<std::pair<double, double>> truth{{0, 1527}, {4, 1526}, {9, 1503}, {14, 1496}, {30, 1494}},
      assumed{{0, 1521}, {7, 1520}, {12, 1496}, {30, 1494}};
  const auto tables = [&](const TestFolder& folder) {
    folder.write("true.csv", table_of(truth));
    folder.write("assumed.csv", table_of(assumed));
  };
  const std::string water = "[water]\nprofile = \"table\"\nprofile_file = \"true.csv\"\n";
  const auto right = soundings_of(level_scene(processed_fan(), "", water), tables),
             same = soundings_of(
                 level_scene(processed_fan(),
                             "[processing.water]\nprofile = \"table\"\nprofile_file = \"true.csv\"\n", water),
                 tables),
             wrong = soundings_of(
                 level_scene(processed_fan(),
                             "[processing.water]\nprofile = \"table\"\nprofile_file = \"assumed.csv\"\n",
                             water),
                 tables);
  ASSERT_EQ(right.size(), 63u);
  ASSERT_EQ(wrong.size(), 63u);
  ASSERT_EQ(same.size(), 63u);
  double largest_m = 0;
  for (std::size_t k = 0; k < right.size(); ++k) {
    SCOPED_TRACE(testing::Message() << "ping " << right[k].ping << " beam " << right[k].beam);
    // With the true profile, the error is that of the detector.
    EXPECT_NEAR(right[k].up, bed_m, 0.02);
    EXPECT_EQ(same[k].up, right[k].up);
    const double angle = std::abs(right[k].angle_deg) * degree;
    EXPECT_EQ(wrong[k].angle_deg, right[k].angle_deg);
    const double true_speed = 1526.5, time_s = right[k].range / true_speed;  // at a depth of 2 m
    EXPECT_NEAR(wrong[k].range / right[k].range, (1521 - 2.0 / 7) / true_speed, 2e-5);
    const RayEnd seen = traced(assumed, 2, angle, time_s), real = traced(truth, 2, angle, time_s);
    EXPECT_NEAR(-right[k].up, real.depth_m, 1e-3);
    EXPECT_NEAR(-wrong[k].up, seen.depth_m, 1e-3);
    EXPECT_NEAR(std::abs(from_sonar(wrong[k]).starboard), seen.across_m, 1e-3);
    EXPECT_NEAR(wrong[k].up - right[k].up, real.depth_m - seen.depth_m, 1e-3);
    largest_m = std::max(largest_m, std::abs(wrong[k].up - right[k].up));
  }
  EXPECT_GT(largest_m, 0.15);  // the artefact is larger than all tolerances
}

// With the true profile, the error is that of the detector.
TEST(ProcessingRun, TheShippedSurveyRecoversTheSeabedWithTheTrueProfile) {
  const std::filesystem::path shipped = std::filesystem::path(TUBEFOOT_SOURCE_DIR) / "scenes/processing";
  const std::string wrong = bytes_of(shipped / "wrong-profile.toml"),
                    assumed = "[processing.water]\nprofile = \"cast\"\nprofile_file = \"assumed-cast.csv\"\n";
  const std::size_t at = wrong.find(assumed);
  ASSERT_NE(at, std::string::npos);
  const auto farthest_m = [&](const std::string& scene) {
    const TestFolder folder;
    for (const char* cast : {"true-cast.csv", "assumed-cast.csv"})
      std::filesystem::copy_file(shipped / cast, folder / cast);
    run(folder, scene);
    const std::vector<CsvSounding> soundings = soundings_in(folder / "out/multibeam-soundings.csv");
    EXPECT_GT(soundings.size(), 3000u);
    double farthest = 0;
    for (const CsvSounding& s : soundings) farthest = std::max(farthest, std::abs(s.up + 25));
    return farthest;
  };
  std::string right = wrong;
  EXPECT_LE(farthest_m(right.erase(at, assumed.size())), 0.02 + 1e-9);
  EXPECT_GT(farthest_m(wrong), 0.5);
}

std::vector<std::string> gsf_texts(const std::filesystem::path& path,
                                   std::vector<std::pair<double, double>>& profile) {
  samples::PacketReader file(samples::file_content(path), true);
  std::vector<std::string> parameters;
  for (std::size_t at = 0; at < file.size(); at += 8 + file.u32(at)) {
    samples::PacketReader record(file.part(at + 8, file.u32(at)), true);
    if (file.u32(at + 4) == 4)
      for (std::size_t k = 0, place = 10; k < record.u16(8); ++k, place += 2 + record.u16(place))
        parameters.push_back(record.text(place + 2, record.u16(place)));
    if (file.u32(at + 4) == 3)
      for (std::size_t k = 0; k < record.u32(24); ++k)
        profile.emplace_back(record.u32(28 + 8 * k) / 100.0, record.u32(32 + 8 * k) / 100.0);
  }
  return parameters;
}

TEST(ProcessingRun, Files_StateTheAssumedWater) {
  const TestFolder folder;
  run(folder, level_scene(processed_fan(),
                          "[processing]\nsound_speed_at_transducer_m_s = 1490\ntide_m = 0.5\n"
                          "[processing.water]\nprofile = \"gradient\"\nsound_speed_m_s = 1480\n"
                          "gradient_per_s = 1\nprofile_bottom_m = 30\n"));
  std::vector<std::pair<double, double>> profile;
  const auto parameters = gsf_texts(folder / "out/sonar.gsf", profile);
  EXPECT_THAT(parameters, AllOf(Contains("RAY_TRACING=YES"), Contains("TIDE_COMPENSATED=YES")));
  EXPECT_THAT(profile, testing::ElementsAre(std::pair(0.0, 1480.0), std::pair(30.0, 1510.0)));
  const NetcdfReader sonar(folder / "out/sonar-sonar.nc");
  for (const double speed : sonar.values("/Sonar/Beam_group1", "sound_speed_at_transducer"))
    EXPECT_EQ(speed, 1490);
  EXPECT_NEAR(sonar.values("/Environment", "sound_speed_indicative").at(0), 1482, 1e-3);
  // Travel times are measured, so they are the true ones.
  const auto rows = csv_rows(folder / "out/sonar-soundings.csv");
  for (const auto& row : rows)
    EXPECT_NEAR(std::stod(row.at("slant_range_m")), 1482 * std::stod(row.at("two_way_travel_time_s")) / 2,
                file_rounding_m);
  const NetcdfReader echoes(folder / "out/echoes.nc");
  EXPECT_EQ(echoes.number("/", "sound_speed_m_s"), 1500);
}

const std::string all_kinds =
    processed_fan() +
    "[[sensors]]\nname = \"side\"\nkind = \"sidescan\"\ndepression_min_deg = 20\nrange_max_m = 60\n"
    "samples = 300\nfirst_ping_s = 1\npings = 3\n"
    "[[sensors]]\nname = \"pair\"\nkind = \"interferometric\"\nrange_max_m = 60\nsamples = 300\n"
    "first_ping_s = 1\npings = 2\n"
    "[[sensors]]\nname = \"single\"\nkind = \"echosounder\"\nrange_max_m = 30\nsamples = 300\n"
    "first_ping_s = 1\npings = 3\n"
    "[[sensors]]\nname = \"camera\"\npreset = \"didson-detection\"\nbeams = 48\ntilt_deg = 60\n"
    "window_start_m = 16.8\nwindow_length_m = 10\nfirst_ping_s = 1\npings = 2\n";

/// The same scene with the true values in the sections of the assumed configuration.
std::string with_true_values(std::string scene) {
  scene = replaced(scene, "[[sensors]]\nname = \"side\"",
                   "[sensors.processing]\nyaw_deg = 0\nroll_deg = 0\nlever_arm_m = [0, 0, 0]\n"
                   "[[sensors]]\nname = \"side\"");
  return scene +
         "[sensors.processing]\ntilt_deg = 60\n[processing]\nsound_speed_at_transducer_m_s = 1500\n"
         "latency_s = 0\ntide_m = 0\nattitude_bias_deg = [0, 0, 0]\nposition_noise_m = [0, 0, 0]\nseed = 5\n"
         "[processing.water]\nsound_speed_m_s = 1500\n";
}

std::vector<std::uint64_t> bits(const std::vector<double>& values) {
  std::vector<std::uint64_t> all;
  for (const double value : values) all.push_back(std::bit_cast<std::uint64_t>(value));
  return all;
}

TEST(ProcessingRun, TrueValues_WriteTheSameBytes) {
  const TestFolder truth, assumed;
  run(truth, level_scene(all_kinds, ""));
  run(assumed, with_true_values(level_scene(all_kinds, "")));
  const auto names = names_below(truth / "out");
  EXPECT_EQ(names_below(assumed / "out"), names);
  EXPECT_GT(names.size(), 15u);
  for (const std::string& name : names) {
    // Statistics and echoes contain the scene hash. HDF5 and SQLite store the time at which they write.
    if (name.ends_with(".json") || name.ends_with(".nc") || name.ends_with(".gpkg")) continue;
    EXPECT_TRUE(bytes_of(truth / ("out/" + name)) == bytes_of(assumed / ("out/" + name))) << name;
  }
  const NetcdfReader sonar(truth / "out/sonar-sonar.nc"), same(assumed / "out/sonar-sonar.nc");
  const std::string bathymetry = "/Sonar/Beam_group1/Bathymetry";
  for (const char* variable : {"detection_x", "detection_y", "detection_z"})
    EXPECT_TRUE(bits(sonar.values(bathymetry, variable)) == bits(same.values(bathymetry, variable)));
  EXPECT_EQ(sonar.values("/Sonar/Beam_group1", "sound_speed_at_transducer"),
            same.values("/Sonar/Beam_group1", "sound_speed_at_transducer"));
  const NetcdfReader a(truth / "out/echoes.nc"), b(assumed / "out/echoes.nc");
  for (const char* group : {"/sonar", "/side", "/pair", "/single", "/camera"}) {
    EXPECT_EQ(a.variables(group), b.variables(group));
    for (const std::string& variable : a.variables(group))
      EXPECT_EQ(a.values(group, variable.c_str()), b.values(group, variable.c_str())) << group << variable;
  }
}

TEST(ProcessingRun, EchoesStayTheTruth) {
  const TestFolder truth, assumed;
  const std::string processing =
      "[processing]\nlatency_s = 0.25\ntide_m = 1\nattitude_bias_deg = [1, 2, 3]\n"
      "[processing.water]\nsound_speed_m_s = 1450\n";
  run(truth, level_scene(all_kinds, ""));
  run(assumed, level_scene(all_kinds, processing));
  const NetcdfReader a(truth / "out/echoes.nc"), b(assumed / "out/echoes.nc");
  for (const char* group : {"/sonar", "/side", "/pair", "/single", "/camera"}) {
    SCOPED_TRACE(group);
    for (const std::string& variable : a.variables(group))
      EXPECT_EQ(a.values(group, variable.c_str()), b.values(group, variable.c_str())) << variable;
    EXPECT_THAT(b.variables(group), Contains("recorded_sensor_position"));
    const auto position = a.values(group, "sensor_position"),
               recorded = b.values(group, "recorded_sensor_position");
    for (std::size_t ping = 0; 3 * ping < position.size(); ++ping) {
      EXPECT_NEAR(recorded[3 * ping], position[3 * ping] - std::sin(course_deg * degree), 1e-9);
      EXPECT_NEAR(recorded[3 * ping + 1], position[3 * ping + 1] - std::cos(course_deg * degree), 1e-9);
      EXPECT_NEAR(recorded[3 * ping + 2], position[3 * ping + 2] + 1, 1e-9);
    }
    if (std::string(group) == "/camera") continue;  // its pitch is not that of the carrier
    for (const double value : b.values(group, "recorded_sensor_heading")) EXPECT_NEAR(value, 38, 1e-9);
    for (const double value : b.values(group, "recorded_sensor_pitch")) EXPECT_NEAR(value, 2, 1e-9);
    for (const double value : b.values(group, "recorded_sensor_roll")) EXPECT_NEAR(value, 3, 1e-9);
  }
  // Echosounder: the table has the recorded position and range. The bottom lies along the recorded axis.
  const auto rows = csv_rows(assumed / "out/single.csv"), true_rows = csv_rows(truth / "out/single.csv");
  ASSERT_EQ(rows.size(), 3u);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto number = [&](const auto& all, const char* name) { return std::stod(all[k].at(name)); };
    EXPECT_NEAR(number(rows, "range_m"), number(true_rows, "range_m") * 1450 / 1500, 1e-6);
    EXPECT_NEAR(number(rows, "sensor_up_m"), boat_m + 1, 1e-9);
    EXPECT_NEAR(number(rows, "bottom_up_m") - number(rows, "sensor_up_m"),
                -number(rows, "range_m") * std::cos(2 * degree) * std::cos(3 * degree), 1e-6);
    EXPECT_EQ(rows[k].at("true_altitude_m"), true_rows[k].at("true_altitude_m"));
  }
}

// A receiver pair measures a phase, so that the sine of the recorded angle grows with the assumed speed.
TEST(ProcessingRun, ReceiverPair_TakesTheAssumedSpeeds) {
  const TestFolder truth, assumed;
  const std::string pair = all_kinds.substr(all_kinds.find("[[sensors]]\nname = \"pair\""));
  const std::string alone =
      pair.substr(0, pair.find("[[sensors]]", 1)) + "baseline_m = 0.002\nreceiver_pair_tilt_deg = 45\n";
  run(truth, level_scene(alone, ""));
  run(assumed, level_scene(alone, "[processing]\nsound_speed_at_transducer_m_s = 1485\n"));
  const auto a = csv_rows(truth / "out/pair-soundings.csv"), b = csv_rows(assumed / "out/pair-soundings.csv");
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(a.size(), 300u);
  for (std::size_t k = 0; k < a.size(); ++k) {
    const auto sine = [&](const auto& rows) {
      return std::sin((std::stod(rows[k].at("angle_deg")) - 45) * degree);
    };
    EXPECT_EQ(b[k].at("range_m"), a[k].at("range_m"));
    EXPECT_NEAR(sine(b), sine(a) * 1485 / 1500, 1e-7);
  }
}

// The signals of an array are the truth. Its beams are formed with the assumed geometry.
TEST(ProcessingRun, Array_TurnsSoundingsButNotSignals) {
  const std::string scene =
      still_water() + lambert_material("bed", -24) + flat_terrain(30, 3, "centre_m = [0, 0, -15]\n") +
      "[scatterers]\nspacing_m = 0.1\n" + fixed_at(0, 0, 0) +
      "[[sensors]]\nname = \"sonar\"\nkind = \"array\"\ntilt_deg = 90\nfrequency_khz = 100\nbandwidth_khz = "
      "10\npulse_length_us = 500\npulse_taper = 0.1\nrange_min_m = 8\nrange_max_m = 22\nhorizontal_deg = "
      "80\nvertical_deg = 4\nreceivers = 16\nproducts = [\"multibeam\"]\nbeams = 11\nbeams_deg = 60\n";
  const TestFolder truth, assumed;
  run(truth, scene);
  run(assumed, scene + "[processing]\nattitude_bias_deg = [0, 0, 2]\nposition_bias_m = [3, 0, 0]\n");
  const NetcdfReader a(truth / "out/sonar-signals.nc"), b(assumed / "out/sonar-signals.nc");
  for (const char* name : {"pressure", "ping_position", "ping_attitude", "receiver_position"})
    EXPECT_EQ(a.values("/", name), b.values("/", name)) << name;
  const auto right = soundings_in(truth / "out/sonar-soundings.csv"),
             turned = soundings_in(assumed / "out/sonar-soundings.csv");
  ASSERT_GE(right.size(), 9u);
  ASSERT_EQ(turned.size(), right.size());
  // The attitude is an input of the phase detector, so ranges may change. Directions turn by 2 degrees.
  for (std::size_t k = 0; k < right.size(); ++k) {
    const double true_rad = right[k].angle_deg * degree, angle_rad = (turned[k].angle_deg - 2) * degree;
    EXPECT_NEAR(right[k].east, right[k].range * std::sin(true_rad), file_rounding_m);
    EXPECT_NEAR(right[k].up, -right[k].range * std::cos(true_rad), file_rounding_m);
    EXPECT_EQ(turned[k].angle_deg, right[k].angle_deg);
    EXPECT_NEAR(turned[k].east, 3 + turned[k].range * std::sin(angle_rad), file_rounding_m);
    EXPECT_NEAR(turned[k].up, -turned[k].range * std::cos(angle_rad), file_rounding_m);
  }
}

TEST(ProcessingRun, Noise_HasItsRmsAndDoesNotDependOnTheSelection) {
  constexpr std::size_t pings = 4000;
  constexpr unsigned seed = 20261129;
  RecordProperty("seed", int(seed));
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const std::string scene =
      still_water() + lambert_material("bed", -27) + flat_terrain(30, 30, "centre_m = [0, 0, -20]\n") +
      fixed_at(0, 0, -2, "heading_deg = 120\n") +
      fmt::format(
          "[[sensors]]\nname = \"sonar\"\nkind = \"echosounder\"\nbeam_deg = 2\nsamples = 4\n"
          "range_min_m = 10\nrange_max_m = 30\nping_interval_s = 0.01\npings = {}\n",
          pings) +
      fmt::format(
          "[processing]\nattitude_noise_deg = [0.3, 0.2, 0.1]\nposition_noise_m = [1, 2, 0.5]\nseed = {}\n",
          seed);
  const TestFolder all, part;
  run(all, scene);
  part.write("scene.toml", scene);
  ASSERT_EQ(run_program({"run", (part / "scene.toml").string(), "-o", (part / "out").string(), "--quiet",
                         "--pings", "1234:1240"})
                .exit_code,
            0);
  const NetcdfReader whole(all / "out/echoes.nc"), some(part / "out/echoes.nc");
  std::vector<std::vector<double>> errors(6);
  const auto position = whole.values("/", "recorded_sensor_position");
  for (std::size_t ping = 0; ping < pings; ++ping)
    for (std::size_t k = 0; k < 3; ++k) errors[k].push_back(position[3 * ping + k] - (k == 2 ? -2 : 0));
  const char* names[] = {"recorded_sensor_heading", "recorded_sensor_pitch", "recorded_sensor_roll"};
  for (std::size_t k = 0; k < 3; ++k)
    for (const double value : whole.values("/", names[k]))
      errors[3 + k].push_back(value - (k == 0 ? 120 : 0));
  const double rms[] = {1, 2, 0.5, 0.3, 0.2, 0.1};
  const auto mean_product = [&](std::size_t i, std::size_t j, std::size_t lag) {
    double sum = 0;
    for (std::size_t ping = lag; ping < pings; ++ping) sum += errors[i][ping] * errors[j][ping - lag];
    return sum / double(pings) / rms[i] / rms[j];
  };
  const double sigma = 1 / std::sqrt(double(pings));
  for (std::size_t i = 0; i < 6; ++i) {
    double mean = 0;
    for (const double error : errors[i]) mean += error / double(pings) / rms[i];
    EXPECT_NEAR(mean, 0, 4 * sigma);
    EXPECT_NEAR(mean_product(i, i, 0), 1, 4 * std::sqrt(2.0) * sigma);
    for (std::size_t j = 0; j < 6; ++j) {
      if (i != j) {
        EXPECT_NEAR(mean_product(i, j, 0), 0, 4.5 * sigma);
      }
      EXPECT_NEAR(mean_product(i, j, 1), 0, 4.5 * sigma);
    }
  }
  const auto selected = some.values("/", "recorded_sensor_position");
  ASSERT_EQ(selected.size(), 3 * 7u);
  for (std::size_t k = 0; k < selected.size(); ++k) EXPECT_EQ(selected[k], position[3 * 1234 + k]);
}

TEST(ProcessingRun, Check_StatesTheDifference) {
  const TestFolder folder;
  const auto checked = [&](const std::string& processing) {
    folder.write("scene.toml", level_scene(processed_fan(), processing));
    const Outcome outcome = run_program({"check", (folder / "scene.toml").string()});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out;
  };
  EXPECT_THAT(checked("[processing]\nlatency_s = 0\n"), testing::Not(HasSubstr("files assume")));
  EXPECT_THAT(
      checked("[processing]\nlatency_s = 0.25\nattitude_bias_deg = [0, 0, 2]\n"
              "sound_speed_at_transducer_m_s = 1480\n[processing.water]\nsound_speed_m_s = 1450\n"),
      HasSubstr("files assume: sound speed 1450.00 m/s, 1480.00 m/s for steering, positions off by up "
                "to 1 m, attitudes off by up to 2 degrees"));
}

TEST(ProcessingRun, Errors_NameTheKeyAndTheTimes) {
  const TestFolder folder;
  const auto error_of = [&](const std::string& scene) {
    folder.write("scene.toml", scene);
    const Outcome outcome = run_program({"check", (folder / "scene.toml").string()});
    EXPECT_NE(outcome.exit_code, 0);
    return outcome.err;
  };
  EXPECT_THAT(
      error_of(level_scene(processed_fan(), "[processing]\nlatency_s = 1.5\n")),
      AllOf(HasSubstr("scene.toml:"), HasSubstr("with 'latency_s' = 1.5, the value recorded at 1 s is "
                                                "that of -0.5 s, but the trajectory lasts from 0 s to 5 s")));
  EXPECT_THAT(error_of(level_scene(processed_fan(), "[processing]\nattitude_latency_s = -3.5\n")),
              HasSubstr("that of 5.5 s, but the trajectory lasts from 0 s to 5 s"));
  // The turn between the lines of a survey is not simulated.
  std::string survey = level_scene(processed_fan("first_ping_s = 0\n"), "[processing]\nlatency_s = 0.5\n");
  survey =
      replaced(replaced(survey, "first_ping_s = 1\npings = 3\n", ""), oblique_course,
               "[trajectory]\nkind = \"survey\"\nlength_m = 20\nwidth_m = 20\nspacing_m = 20\ndepth_m = 2\n");
  EXPECT_THAT(error_of(survey), HasSubstr("the line lasts from 0 s to 20 s"));
  folder.write("tide.csv", "time_s,tide_m\n0,0\n1.5,1\n");
  EXPECT_THAT(error_of(level_scene(processed_fan(), "[processing]\ntide_file = \"tide.csv\"\n")),
              AllOf(HasSubstr("scene.toml:"), HasSubstr("a transmission is at 2 s"),
                    HasSubstr("lasts from 0 s to 1.5 s")));
  folder.write("tide.csv", "time_s,tide_m\n0,0\n0,1\n");
  EXPECT_THAT(error_of(level_scene(processed_fan(), "[processing]\ntide_file = \"tide.csv\"\n")),
              HasSubstr("time_s must increase"));
}

}  // namespace
}  // namespace tubefoot
