// SPDX-License-Identifier: GPL-3.0-or-later
// Tests motion within a ping together with other features: gaps between beams, mounting, assumed
// configuration, moving objects, check and SONAR-netCDF4 files. Each combination was wrong once.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "fixtures/covered.hpp"
#include "fixtures/multibeam_runs.hpp"
#include "fixtures/netcdf_reader.hpp"
#include "fixtures/world/echoes.hpp"
#include "run/survey.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

constexpr double water_depth_m = 20;

/// A boat over a level seabed at height 0, which rolls and pitches at constant rates. Roll is 6 and pitch 4
/// degrees at the ping.
std::string boat_track(double roll_deg_s = 12, double pitch_deg_s = 8, double yaw_deg_s = 0,
                       double speed_m_s = 2) {
  std::string rows = "time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg\n";
  for (int k = 0; k <= 60; ++k) {
    const double t = 0.02 * k;
    rows += fmt::format("{:.3f},0,{:.17g},{},{:.17g},{:.17g},{:.17g}\n", t, speed_m_s * t, water_depth_m,
                        yaw_deg_s * t, pitch_deg_s * t, roll_deg_s * t);
  }
  return rows;
}

std::string boat_scene(const std::string& sensor_keys, const std::string& more = {}) {
  return "[georeference]\norigin_lat_lon_deg = [59.0, 10.0]\n" + still_water() +
         lambert_material("bed", -20) + flat_terrain(400, 400) +
         "[trajectory]\nname = \"boat\"\nkind = \"waypoints\"\nfile = \"track.csv\"\n"
         "[[sensors]]\nname = \"swath\"\nkind = \"multibeam\"\nbeam_across_deg = 2\nalong_track_deg = 2\n"
         "range_min_m = 4\nrange_max_m = 54\nsamples = 1000\nfirst_ping_s = 0.5\n" +
         sensor_keys + more;
}

const std::string in_motion = "stop_and_hop = false\n";

struct MotionCombinations : testing::Test {
  TestFolder folder;

  std::vector<multibeam_for_tests::CsvSounding> soundings(const std::string& scene) {
    folder.write("track.csv", boat_track());
    multibeam_for_tests::run(folder, scene);
    return multibeam_for_tests::soundings_in(folder / "out/swath-soundings.csv");
  }
  std::string error_of(const std::string& scene) {
    folder.write("track.csv", boat_track());
    try {
      open_survey(read_scene_file(folder.write("scene.toml", scene)));
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }
};

// The transmitter insonifies the gaps between the beams. A beam that turns into a gap receives as much as
// among contiguous beams.
TEST_F(MotionCombinations, BeamsTurnIntoInsonifiedGaps) {
  folder.write("track.csv", boat_track(40, 0));
  std::string dense;
  for (int angle = -40; angle <= 40; angle += 2)
    dense += fmt::format("{}{}", dense.empty() ? "" : ", ", angle);
  const Echoes sparse = echoes_in(folder,
                                  boat_scene("beam_angles_deg = [-40, -30, -20, -10, 0, 10, 20, 30, 40]\n" +
                                             in_motion + "motion_step_beams = 0.05\n")),
               full = echoes_in(folder, boat_scene("beam_angles_deg = [" + dense + "]\n" + in_motion +
                                                   "motion_step_beams = 0.05\n"));
  ASSERT_EQ(sparse.beams, 9u);
  for (std::size_t beam = 0; beam < sparse.beams; ++beam) {
    EXPECT_GT(full.beam_total(0, 5 * beam), 0);
    EXPECT_NEAR(sparse.beam_total(0, beam), full.beam_total(0, 5 * beam), 5e-3 * full.beam_total(0, 5 * beam))
        << beam;
  }
}

// Roll beyond a few degrees within a ping loses no energy of the outermost beams.
TEST_F(MotionCombinations, OutermostBeamsOfAFastRollReceive) {
  folder.write("track.csv", boat_track(120, 0));
  const Echoes moving = echoes_in(folder, boat_scene("beams = 41\nswath_deg = 80\n" + in_motion));
  // Roll of 60 degrees and more turns the beams to port, so that the starboard side looks steeper.
  for (std::size_t beam = 25; beam < moving.beams; ++beam) EXPECT_GT(moving.beam_total(0, beam), 0) << beam;
}

TEST_F(MotionCombinations, ASonarThatIsMountedBackwardsIsStabilised) {
  for (const std::string& motion : {std::string(), in_motion}) {
    const auto found = soundings(boat_scene(
        "beams = 21\nswath_deg = 80\nyaw_deg = 180\nstabilisation = [\"roll\", \"pitch\"]\n" + motion));
    ASSERT_EQ(found.size(), 21u);
    for (const auto& sounding : found) EXPECT_NEAR(sounding.up, 0, 0.03) << sounding.beam;
    // Its port is to the east.
    EXPECT_NEAR(found.front().east, water_depth_m * std::tan(radians(40)), 0.4);
    EXPECT_NEAR(found.back().east, -water_depth_m * std::tan(radians(40)), 0.4);
    EXPECT_NEAR(found[10].north, 1, 0.1);
  }
  EXPECT_THAT(error_of(boat_scene("yaw_deg = 90\nstabilisation = [\"roll\"]\n")),
              HasSubstr("'yaw_deg' is 90, expected a value within 30 degrees of 0 or 180"));
}

// A flat array records asin(ratio sin(angle)), where the angle includes the steering.
TEST_F(MotionCombinations, RecordedAnglesIncludeTheSteering) {
  const std::string keys = "beams = 11\nswath_deg = 80\nstabilisation = [\"roll\"]\n";
  const auto truth = soundings(boat_scene(keys)),
             assumed = soundings(boat_scene(keys, "[processing]\nsound_speed_at_transducer_m_s = 1515\n"));
  ASSERT_EQ(truth.size(), assumed.size());
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double steered_deg = -40 + 8 * double(truth[k].beam) + 6;
    EXPECT_NEAR(truth[k].angle_deg, steered_deg, 1e-9);
    EXPECT_NEAR(assumed[k].angle_deg, degrees(std::asin(1.01 * std::sin(radians(steered_deg)))), 1e-9);
  }
}

// The recorded pose of the receiver keeps its arm.
TEST_F(MotionCombinations, AnErrorOfAttitudeKeepsTheArmOfTheReceiver) {
  const std::string keys = "beams = 11\nswath_deg = 80\nreceiver_arm_m = [0, 2, 0]\n" + in_motion;
  const auto truth = soundings(boat_scene(keys)),
             assumed = soundings(boat_scene(keys, "[processing]\nattitude_bias_deg = [1e-7, 0, 0]\n"));
  ASSERT_EQ(truth.size(), 11u);
  ASSERT_EQ(assumed.size(), truth.size());
  for (std::size_t k = 0; k < truth.size(); ++k) {
    EXPECT_NEAR(assumed[k].east, truth[k].east, 1e-3);
    EXPECT_NEAR(assumed[k].north, truth[k].north, 1e-3);
  }
}

TEST_F(MotionCombinations, AnObjectOnTheTrackOfTheSonarIsAnError) {
  const std::string hull =
      "[[objects]]\nname = \"hull\"\nshape = \"box\"\nsize_m = [2, 6, 1]\nposition_m = [0, 0, 1]\n"
      "trajectory = \"boat\"\n";
  EXPECT_EQ(error_of(boat_scene("beams = 11\nswath_deg = 80\n", hull)), "");
  EXPECT_THAT(error_of(boat_scene("beams = 11\nswath_deg = 80\n" + in_motion, hull)),
              HasSubstr("object 'hull' on its trajectory has the pose of the transmission until the echo "
                        "arrives"));
}

constexpr const char* own_sectors =
    "beams = 21\nswath_deg = 80\nsector_edges_deg = [-60, -20, 20, 60]\n"
    "sector_frequencies_khz = [260, 320, 290]\nsector_pulse_lengths_us = [50, 60, 70]\n";

// The sector fixes the direction along the track from the place of the transmission. Ranges are those of stop
// and hop.
TEST_F(MotionCombinations, SoundingsLieInTheSectorOfTheTransmission) {
  constexpr double speed_m_s = 10;
  for (const double facing : {1.0, -1.0}) {
    const auto found = [&](const std::string& more) {
      folder.write("track.csv", boat_track(0, 0, 0, speed_m_s));
      multibeam_for_tests::run(
          folder, boat_scene(std::string(own_sectors) +
                             "sector_tilts_deg = [2, -1, 1]\nsector_delays_us = [0, 10000, 20000]\n" +
                             (facing < 0 ? "yaw_deg = 180\n" : "") + more));
      return multibeam_for_tests::soundings_in(folder / "out/swath-soundings.csv");
    };
    const auto moving = found(in_motion), hop = found("");
    ASSERT_EQ(moving.size(), 21u);
    ASSERT_EQ(hop.size(), 21u);
    for (std::size_t k = 0; k < moving.size(); ++k) {
      const auto& s = moving[k];
      const std::size_t sector = s.beam < 5 ? 0 : s.beam < 15 ? 1 : 2;
      const double tilt = std::array{2.0, -1.0, 1.0}[sector], sent_s = 0.5 + 0.01 * double(sector),
                   angle = radians(s.angle_deg);
      EXPECT_NEAR(s.north,
                  speed_m_s * sent_s + facing * water_depth_m * std::tan(radians(tilt)) / std::cos(angle),
                  0.005);
      EXPECT_NEAR(s.east, hop[k].east, 0.005);
      EXPECT_NEAR(s.up, hop[k].up, 0.005);
    }
  }
}

// Intervals have common borders, between which no strip is lost.
TEST_F(MotionCombinations, AreasOfManyIntervalsAddUp) {
  const auto seen_m2 = [&](double step_beams) {
    folder.write("track.csv", boat_track(0, 0, 0, 10));
    return covered(folder, boat_scene("beams = 50\nswath_deg = 98\n" + in_motion +
                                      fmt::format("motion_step_beams = {}\n", step_beams)))
        .seen_m2;
  };
  const double coarse_m2 = seen_m2(0.5);
  EXPECT_NEAR(seen_m2(0.01), coarse_m2, 1e-3 * coarse_m2);
}

TEST_F(MotionCombinations, StabilisationAgainstAFastTurnIsAnError) {
  folder.write("track.csv", boat_track(0, 0, 300));
  try {
    open_survey(read_scene_file(
        folder.write("scene.toml", boat_scene(std::string(own_sectors) + "stabilisation = [\"yaw\"]\n"))));
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("the stabilisation of sensor 'swath' needs a tilt of"));
  }
}

TEST_F(MotionCombinations, CheckPrintsEachSector) {
  folder.write("track.csv", boat_track());
  folder.write("scene.toml", boat_scene(own_sectors + in_motion));
  const Outcome outcome = run_program({"check", (folder / "scene.toml").string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* line : {"sector 0: beams 0 to 4, 260 kHz", "sector 1: beams 5 to 14, 320 kHz",
                           "sector 2: beams 15 to 20, 290 kHz"})
    EXPECT_THAT(outcome.out, HasSubstr(line));
}

TEST_F(MotionCombinations, SonarNetcdfStatesTheSteering) {
  soundings(boat_scene(std::string(own_sectors) + "sector_tilts_deg = [-1, 0, 1]\n" +
                       "stabilisation = [\"roll\", \"pitch\"]\n" + in_motion));
  const NetcdfReader file(folder / "out/swath-sonar.nc");
  const std::string group = "/Sonar/Beam_group1";
  EXPECT_THAT(file.codes(group, "beam_stabilisation"), testing::ElementsAre(1));
  const std::vector<double> phi = file.values(group, "tx_beam_rotation_phi"),
                            theta = file.values(group, "tx_beam_rotation_theta"),
                            width = file.values(group, "beamwidth_receive_major");
  ASSERT_EQ(phi.size(), 3u);
  // The middle sector has its centre 2 degrees to port. Roll of 6 degrees turns it to starboard. Pitch p of
  // 4 degrees tilts it by the solution t of cos(t) sin(p) cos(2 degrees) + sin(t) cos(p) = 0.
  EXPECT_NEAR(-phi[1], -2 + 6, 1e-4);
  EXPECT_NEAR(theta[1], -degrees(std::atan(std::tan(radians(4)) * std::cos(radians(2)))), 1e-4);
  EXPECT_GT(theta[2], theta[1]);
  EXPECT_GT(phi[0], phi[1]);
  EXPECT_NEAR(width.front(), 30, 1e-6);
}

// Readers of RESON 8101 packets assume the angles of the beams.
TEST_F(MotionCombinations, Reson8101PacketsAreForBeamsThatAreNotSteered) {
  const auto sonar_type = [&](const std::string& keys, const std::string& more = {}) {
    folder.write("track.csv", boat_track());
    std::string scene =
        replaced(boat_scene(keys, more), "kind = \"multibeam\"\nbeam_across_deg = 2\nalong_track_deg = 2\n",
                 "preset = \"reson-8101\"\n");
    multibeam_for_tests::run(folder, scene);
    std::ifstream file(folder / "out/swath.xtf", std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), {});
    // The packet type 28 (0x1C) has the magic number 0xFACE before it.
    return bytes.find(std::string("\xCE\xFA\x1C", 3)) == std::string::npos;
  };
  EXPECT_TRUE(sonar_type(""));
  EXPECT_FALSE(sonar_type("stabilisation = [\"roll\"]\n"));
  EXPECT_FALSE(sonar_type(in_motion));
  EXPECT_FALSE(sonar_type("", "[processing]\nsound_speed_at_transducer_m_s = 1510\n"));
}

}  // namespace
}  // namespace tubefoot
