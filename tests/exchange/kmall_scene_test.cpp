// SPDX-License-Identifier: GPL-3.0-or-later
// Tests scenes of survey lines: sensors, times, track and seabed. One line is the recording of the
// repository, another one is built, and its geometry has closed forms.
#include "exchange/readers/kmall_scene.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>

#include "fixtures/csv_rows.hpp"
#include "fixtures/kmall_builder.hpp"
#include "fixtures/kmall_recordings.hpp"
#include "fixtures/program.hpp"
#include "fixtures/refusal.hpp"
#include "fixtures/world/echoes.hpp"
#include "run/survey.hpp"
#include "sensors/kinds/kind_multibeam.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pointwise;

struct KmallScenes : testing::Test {
  TestFolder folder;
  KmallSceneReport report;

  std::filesystem::path scene_file(const std::string& name) const { return folder / (name + "/scene.toml"); }
  SceneDescription import_survey(const KmallSurvey& survey, const KmallSceneOptions& options = {},
                                 const std::string& name = "scene") {
    std::filesystem::create_directory(folder / name);
    report = write_kmall_scene(survey, options, folder / name);
    return read_scene_file(scene_file(name));
  }
  KmallSurvey built(const kmall_for_tests::Line& line) const {
    folder.write("line.kmall", line.soundings_file());
    folder.write("line.kmwcd", line.column_file());
    return read_kmall_survey(folder / "line.kmall", true);
  }
};

const MultibeamDescription& multibeam(const SensorDescription& sensor) {
  return sensor.kind.as<MultibeamDescription>();
}

const KmallSurvey& recording() {
  static const KmallSurvey survey = read_kmall_survey(repository_recording, true);
  return survey;
}

constexpr double recording_start_s = 1764243336;

/// A column of a track, linear between its rows.
double track_value(const std::filesystem::path& file, double time_s, const char* column) {
  const std::string text = bytes_of(file);
  const TestFolder folder;
  const auto rows = csv_rows(folder.write("track.csv", text.substr(text.find("time_s,"))));
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const double from_s = std::stod(rows[k - 1].at("time_s")), to_s = std::stod(rows[k].at("time_s"));
    if (time_s < from_s || time_s > to_s) continue;
    return std::lerp(std::stod(rows[k - 1].at(column)), std::stod(rows[k].at(column)),
                     (time_s - from_s) / (to_s - from_s));
  }
  throw std::runtime_error("the track does not contain the time");
}

/// Residuals of all valid soundings from a plane of the scene. The line is so short that the Earth is flat.
double rms_from_plane_m(const KmallSurvey& survey, const FlatTerrain& plane) {
  constexpr double metres_per_degree = 111320;
  const KmallPing& first = survey.pings.front();
  const double fall = std::tan(glm::radians(plane.slope_deg)), to = glm::radians(plane.slope_heading_deg);
  double squares = 0, count = 0;
  for (const KmallPing& ping : survey.pings) {
    const double heading = glm::radians(ping.heading_deg);
    for (const KmallSounding& s : ping.soundings) {
      if (!s.is_valid) continue;
      const double east = (ping.longitude_deg - first.longitude_deg) * metres_per_degree *
                              std::cos(glm::radians(first.latitude_deg)) +
                          s.x_m * std::sin(heading) + s.y_m * std::cos(heading);
      const double north = (ping.latitude_deg - first.latitude_deg) * metres_per_degree +
                           s.x_m * std::cos(heading) - s.y_m * std::sin(heading);
      const double height = plane.centre_m[2] - fall * ((east - plane.centre_m[0]) * std::sin(to) +
                                                        (north - plane.centre_m[1]) * std::cos(to));
      squares += std::pow(ping.waterline_m - s.z_m - height, 2);
      ++count;
    }
  }
  return std::sqrt(squares / count);
}

TEST_F(KmallScenes, HaveASensorPerModeOfTheRecording) {
  const SceneDescription scene = import_survey(recording());
  EXPECT_EQ(scene.run.start_utc, "2025-11-27T11:35:36Z");
  std::vector<std::string> names;
  std::vector<double> times_s;
  for (const SensorDescription& sensor : scene.sensors) {
    names.push_back(sensor.name);
    EXPECT_TRUE(std::ranges::is_sorted(sensor.ping_times_s));
    times_s.insert(times_s.end(), sensor.ping_times_s.begin(), sensor.ping_times_s.end());
    const MultibeamDescription& fan = multibeam(sensor);
    ASSERT_EQ(fan.beam_angles_deg.size(), 256u);
    EXPECT_TRUE(std::ranges::is_sorted(fan.beam_angles_deg));
    EXPECT_EQ(fan.sector_edges_deg.size(), fan.sector_tilts_deg.size() + 1);
    for (const double tilt_deg : fan.sector_tilts_deg) EXPECT_GT(tilt_deg, 0) << "the tilts are forward";
  }
  EXPECT_THAT(names, ElementsAre("mode-190-220", "mode-260-320-290", "mode-320-380-320", "mode-680"));
  const MultibeamDescription& first = multibeam(scene.sensors[0]);
  EXPECT_NEAR(first.beam_angles_deg.front(), -65, 1e-3);
  EXPECT_NEAR(first.beam_angles_deg.back(), 65, 1e-3);
  EXPECT_THAT(first.sector_tilts_deg, Pointwise(DoubleNear(1e-4), {0.7117, 0.5363}));
  EXPECT_THAT(first.sector_frequencies_khz, ElementsAre(190, 220));
  EXPECT_THAT(multibeam(scene.sensors[1]).sector_frequencies_khz, ElementsAre(260, 320, 290));
  EXPECT_EQ(report.sensors, 4u);
  EXPECT_EQ(report.pings, 5u);
  // The times are those of the headers of the file .kmwcd.
  std::vector<double> expected_s;
  std::filesystem::path column = repository_recording;
  for (const KmallRecord& record : KmallFile(column.replace_extension(".kmwcd")).records("#MWC"))
    expected_s.push_back(record.time_s - recording_start_s);
  std::ranges::sort(times_s);
  EXPECT_THAT(times_s, Pointwise(DoubleNear(1e-6), expected_s));
}

TEST_F(KmallScenes, LoadWithTheBeamsAndPingsOfTheRecording) {
  for (const char* seabed : {"plane", "grid"}) {
    SCOPED_TRACE(seabed);
    KmallSceneOptions options;
    options.seabed = seabed;
    const auto survey = open_survey(import_survey(recording(), options, seabed));
    ASSERT_EQ(survey->sensors.size(), recording().modes.size());
    for (std::size_t s = 0; s < survey->sensors.size(); ++s) {
      const KmallMode& mode = recording().modes[s];
      const SensorPings& pings = survey->sensors[s];
      EXPECT_EQ(pings.sensor->beams().size(), 256u);
      EXPECT_EQ(pings.times_s.size(), mode.pings.size());
      EXPECT_EQ(pings.sensor->firings(), mode.sectors.size());
      // The range bins are as long as the samples.
      EXPECT_NEAR(pings.sensor->samples().step_m * 2 * mode.sample_rate_hz / pings.sound_speed_m_s, 1, 1e-6);
    }
  }
}

TEST_F(KmallScenes, HaveTheHeightAndHeadingOfThePings) {
  import_survey(recording());
  for (const KmallPing& ping : recording().pings) {
    const double time_s = ping.time_s - recording_start_s;
    if (time_s > 1.75) continue;  // the scene ends with the water column
    EXPECT_NEAR(track_value(folder / "scene/track.csv", time_s, "up_m"), ping.waterline_m, 0.02);
    EXPECT_NEAR(track_value(folder / "scene/track.csv", time_s, "heading_deg"), ping.heading_deg, 0.1);
  }
}

TEST_F(KmallScenes, HaveAPlaneNearTheSoundings) {
  KmallSceneOptions options;
  options.seabed = "plane";
  const SceneDescription scene = import_survey(recording(), options);
  ASSERT_EQ(scene.terrains.size(), 1u);
  const auto& plane = std::get<FlatTerrain>(scene.terrains[0].kind);
  EXPECT_LT(rms_from_plane_m(recording(), plane), 0.05);
  // Along the track, the soundings of the ship at anchor extend by 1 m, which determines no slope.
  EXPECT_LT(plane.slope_deg, 1.5);
  EXPECT_THAT(report.notes,
              Contains(AllOf(HasSubstr("seabed: plane at -8."), HasSubstr("rms residual 0.0"))));
  EXPECT_THAT(report.notes, Contains(HasSubstr("narrow strip")));
  EXPECT_THAT(report.notes, Contains(HasSubstr("soundings recomputed from travel times")));
}

TEST_F(KmallScenes, HaveAGridNearTheSoundings) {
  KmallSceneOptions options;
  options.seabed = "grid";
  const SceneDescription scene = import_survey(recording(), options);
  EXPECT_TRUE(scene.terrains.empty());
  ASSERT_EQ(scene.objects.size(), 1u);
  EXPECT_THAT(report.notes, Contains(HasSubstr("seabed: grid of")));
  const auto lines_of = [&](const std::string& name) {
    const std::string text = bytes_of(folder / (name + "/seabed.obj"));
    return std::ranges::count(text, '\n');
  };
  options.cell_m = 2;
  import_survey(recording(), options, "coarse");
  EXPECT_GT(lines_of("scene"), 10 * lines_of("coarse"));
  EXPECT_THAT(report.notes, Contains(HasSubstr("cells of 2.000 m")));
  open_survey(read_scene_file(scene_file("coarse")));
  options.cell_m = 1e-3;
  EXPECT_THAT(refusal<InputError>([&] { import_survey(recording(), options, "fine"); }),
              AllOf(HasSubstr("os02-a.kmall"), HasSubstr("increase the cell size")));
}

TEST_F(KmallScenes, NameARasterAndContainATableOfTheMaterial) {
  KmallSceneOptions options;
  options.seabed = folder
                       .write("harbour.asc",
                              "ncols 2\nnrows 2\nxllcorner -50\nyllcorner -50\ncellsize 100\n"
                              "-9 -9\n-9 -9\n")
                       .string();
  const std::string table = "grazing_deg,level_db\n5,-40\n45,-25\n90,-15\n";
  options.material_table = folder.write("sand.csv", table);
  const SceneDescription scene = import_survey(recording(), options);
  EXPECT_THAT(bytes_of(scene_file("scene")),
              HasSubstr("kind = \"raster\"\nfile = \"" + options.seabed + "\""));
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].model, "table");
  EXPECT_EQ(bytes_of(folder / "scene/material.csv"), table);
}

TEST_F(KmallScenes, AreEqualInEachRun) {
  for (const char* seabed : {"plane", "grid"}) {
    KmallSceneOptions options;
    options.seabed = seabed;
    const std::string one = fmt::format("{}-one", seabed), two = fmt::format("{}-two", seabed);
    import_survey(recording(), options, one);
    import_survey(recording(), options, two);
    const auto files = names_below(folder / one);
    EXPECT_EQ(names_below(folder / two), files);
    EXPECT_GE(files.size(), 2u);
    for (const std::string& name : files)
      EXPECT_EQ(bytes_of(folder / (one + "/" + name)), bytes_of(folder / (two + "/" + name))) << name;
  }
}

TEST_F(KmallScenes, OfABuiltLineHaveItsGeometry) {
  KmallSceneOptions options;
  options.seabed = "plane";
  const KmallSurvey survey = built(kmall_for_tests::two_modes());
  const SceneDescription scene = import_survey(survey, options);
  const auto& plane = std::get<FlatTerrain>(scene.terrains.at(0).kind);
  EXPECT_NEAR(plane.centre_m[2], -11, 1e-3);
  EXPECT_NEAR(plane.slope_deg, 0, 0.01);
  EXPECT_THAT(bytes_of(scene_file("scene")), HasSubstr("sound_speed_m_s = 1500.000"));
  // 0.5 m above the water line; 2 m/s along the heading of 30 degrees.
  const std::filesystem::path track = folder / "scene/track.csv";
  for (const double time_s : {0.125, 1.5, 4.75}) {
    EXPECT_NEAR(track_value(track, time_s, "up_m"), 0.5, 1e-3);
    EXPECT_NEAR(track_value(track, time_s, "heading_deg"), 30, 1e-3);
    EXPECT_NEAR(track_value(track, time_s, "east_m"), 2 * (time_s - 0.125) * 0.5, 0.01);
    EXPECT_NEAR(track_value(track, time_s, "north_m"), 2 * (time_s - 0.125) * std::sqrt(0.75), 0.01);
  }
  ASSERT_EQ(scene.sensors.size(), 2u);
  const SensorDescription& sensor = scene.sensors[0];
  EXPECT_THAT(sensor.lever_arm_m, ElementsAre(0, 0, -1.5));
  EXPECT_THAT(sensor.ping_times_s, Pointwise(DoubleNear(1e-6), {0.125, 2.125, 4.125}));
  EXPECT_EQ(scene.run.start_utc, "2025-11-27T11:35:37Z");
  const MultibeamDescription& fan = multibeam(sensor);
  EXPECT_THAT(fan.beam_angles_deg, Pointwise(DoubleNear(1e-4), {-40.0, -20.0, 20.0, 40.0}));
  EXPECT_THAT(fan.sector_tilts_deg, ElementsAre(0.5, -0.25));
  EXPECT_THAT(fan.sector_absorptions_db_per_km, ElementsAre(60, 90));
  EXPECT_THAT(fan.sector_pulse_lengths_us, Pointwise(DoubleNear(1e-2), {50.0, 50.0}));
  EXPECT_EQ(fan.samples, 200);
  EXPECT_NEAR(fan.range_min_m, 9.5 * 0.075, 1e-6);
}

TEST_F(KmallScenes, GiveEchoesAtTheTravelTimesOfTheSoundings) {
  KmallSceneOptions options;
  options.seabed = "plane";
  const kmall_for_tests::Line line = kmall_for_tests::two_modes();
  import_survey(built(line), options);
  const Outcome outcome = run_program({"run", scene_file("scene").string(), "-o", (folder / "out").string(),
                                       "--pictures", "none", "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const std::size_t mode : {0u, 1u}) {
    const Echoes echoes = read_echoes(folder / "out/echoes.nc", mode == 0 ? "mode-200-300" : "mode-400");
    const kmall_for_tests::Ping& ping = line.pings[mode];
    ASSERT_EQ(echoes.beams, ping.soundings.size());
    for (std::size_t beam = 0; beam < echoes.beams; ++beam) {
      double energy = 0, moment = 0;
      for (std::size_t k = 0; k < echoes.samples; ++k) {
        energy += echoes.at(0, beam, k);
        moment += echoes.at(0, beam, k) * echoes.slant_range_m[k];
      }
      EXPECT_NEAR(moment / energy, 1500 * ping.soundings[beam].time_s / 2, 0.1) << mode << " " << beam;
    }
  }
}

TEST_F(KmallScenes, OfStratifiedWaterHaveAProfile) {
  kmall_for_tests::Line line = kmall_for_tests::two_modes();
  line.profile = {{0, 1490}, {3, 1505}, {50, 1510}};
  import_survey(built(line));
  EXPECT_THAT(bytes_of(scene_file("scene")), HasSubstr("profile_file = \"profile.csv\""));
  const auto rows = csv_rows(folder / "scene/profile.csv");
  ASSERT_EQ(rows.size(), 4u);
  // The measured speed down to the transducer, then the points below it.
  EXPECT_EQ(std::stod(rows[0].at("sound_speed_m_s")), 1500);
  EXPECT_NEAR(std::stod(rows[1].at("depth_m")), 1, 1e-3);
  EXPECT_EQ(std::stod(rows[1].at("sound_speed_m_s")), 1500);
  EXPECT_EQ(std::stod(rows[2].at("sound_speed_m_s")), 1505);
}

TEST_F(KmallScenes, ContainNoKeysFromTextsOfTheFile) {
  kmall_for_tests::Line line = kmall_for_tests::two_modes();
  const std::string sonar = "EM 2042 - synthetic";
  ASSERT_NE(line.installation.find(sonar), std::string::npos);
  line.installation.replace(line.installation.find(sonar), sonar.size(), "EM\n[evil]\nkey = 1\n#");
  KmallSceneOptions options;
  options.seabed = folder.write("sea\"bed.asc", "").string();
  const SceneDescription scene = import_survey(built(line), options);
  EXPECT_EQ(bytes_of(scene_file("scene")).find("\n[evil]"), std::string::npos);
  ASSERT_EQ(scene.terrains.size(), 1u);
  EXPECT_THAT(bytes_of(scene_file("scene")), HasSubstr("sea\\\"bed.asc"));
}

TEST_F(KmallScenes, HavePositionsBeforeTheFirstPing) {
  kmall_for_tests::Line line = kmall_for_tests::two_modes();
  constexpr double metres_per_degree = 111229;
  const double first_s = line.pings[0].time_s, displaced_m = 9;
  line.positions = {
      {0, line.pings[0].latitude_deg - displaced_m / metres_per_degree, line.pings[0].longitude_deg}};
  import_survey(built(line));
  // The track begins shortly before the first ping, which is at the origin of the local frame.
  const double early_s = first_s - 0.04;
  EXPECT_NEAR(track_value(folder / "scene/track.csv", early_s - std::floor(first_s), "north_m"),
              -displaced_m * 0.04 / first_s, 1e-3);
}

TEST_F(KmallScenes, ThatDetermineNoSeabedAreRejected) {
  kmall_for_tests::Line above = kmall_for_tests::two_modes();
  for (kmall_for_tests::Ping& ping : above.pings)
    for (kmall_for_tests::Sounding& s : ping.soundings) s.z_m = -3;
  EXPECT_THAT(refusal<InputError>([&] { import_survey(built(above), {}, "above"); }),
              AllOf(HasSubstr("line.kmall"), HasSubstr("above the water line")));
  kmall_for_tests::Line none = kmall_for_tests::two_modes();
  for (kmall_for_tests::Ping& ping : none.pings)
    for (kmall_for_tests::Sounding& s : ping.soundings) s.detection_type = 2;
  EXPECT_THAT(refusal<InputError>([&] { import_survey(built(none), {}, "none"); }),
              AllOf(HasSubstr("line.kmall"), HasSubstr("0 soundings")));
}

TEST_F(KmallScenes, OfFurtherRecordingsLoad) {
  if (shared_recordings().empty()) GTEST_SKIP() << no_recordings;
  for (const auto& file : shared_recordings()) {
    SCOPED_TRACE(file.string());
    const KmallSurvey survey = read_kmall_survey(file, true);
    for (const char* seabed : {"plane", "grid"}) {
      KmallSceneOptions options;
      options.seabed = seabed;
      const auto loaded =
          open_survey(import_survey(survey, options, file.stem().string() + "-" + std::string(seabed)));
      EXPECT_EQ(loaded->sensors.size(), survey.modes.size());
    }
  }
}

}  // namespace
}  // namespace tubefoot
