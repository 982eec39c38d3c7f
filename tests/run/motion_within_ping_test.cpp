// SPDX-License-Identifier: GPL-3.0-or-later
// Tests carriers that move during a ping. The comparisons are runs at rest, exact delays of point targets,
// signals with phase, and closed forms of steering.
#include "run/motion_within_ping.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <numbers>

#include "fixtures/multibeam_runs.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/test_folder.hpp"
#include "fixtures/world/echoes.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/products/array_files.hpp"
#include "sensors/recordings/pose_angles.hpp"
#include "sensors/recordings/signal_recording.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

constexpr double water_speed_m_s = 1500;

/// Motion at constant rates from time 0, as waypoints every 20 ms.
struct Rates {
  double roll_deg_s = 0, pitch_deg_s = 0, yaw_deg_s = 0, ahead_m_s = 0;
  double until_s = 2;
};

std::string track_file(const Rates& rates) {
  std::string rows = "time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg\n";
  for (double t = 0; t <= rates.until_s + 1e-9; t += 0.02)
    rows += fmt::format("{:.3f},0,{:.17g},20,{:.17g},{:.17g},{:.17g}\n", t, rates.ahead_m_s * t,
                        rates.yaw_deg_s * t, rates.pitch_deg_s * t, rates.roll_deg_s * t);
  return rows;
}

const std::string on_waypoints = "[trajectory]\nkind = \"waypoints\"\nfile = \"track.csv\"\n";
const std::string swath_seabed = still_water() + lambert_material("bed", -20) + flat_terrain(400, 400);

std::string swath_sonar(const std::string& more) {
  return "[[sensors]]\nname = \"swath\"\nkind = \"multibeam\"\nbeams = 24\nswath_deg = 92\n"
         "beam_across_deg = 4\nalong_track_deg = 2\nrange_min_m = 4\nrange_max_m = 44\nsamples = 160\n"
         "first_ping_s = 0.5\n" +
         more;
}

struct MotionWithinPing : testing::Test {
  TestFolder folder;

  Echoes echoes(const Rates& rates, const std::string& scene, const std::string& sensor = {}) {
    folder.write("track.csv", track_file(rates));
    return echoes_in(folder, scene, {}, sensor);
  }
  std::unique_ptr<const Survey> survey(const Rates& rates, const std::string& scene) {
    folder.write("track.csv", track_file(rates));
    return open_survey(read_scene_file(folder.write("scene.toml", scene)));
  }
};

double echo_distance(const Echoes& a, const Echoes& b) {
  EXPECT_EQ(a.energy.size(), b.energy.size());
  double sum = 0;
  for (std::size_t k = 0; k < a.energy.size(); ++k) sum += std::abs(a.energy[k] - b.energy[k]);
  return sum / b.total();
}

TEST_F(MotionWithinPing, OfACarrierAtRestChangesNoBit) {
  for (const std::string& sensor :
       {swath_sonar(""),
        std::string("[[sensors]]\nname = \"side\"\nkind = \"sidescan\"\nsamples = 100\nfirst_ping_s = 0.5\n"
                    "range_max_m = 60\n"),
        std::string("[[sensors]]\nname = \"camera\"\nkind = \"didson\"\ntilt_deg = 60\nsamples = 64\n"
                    "window_start_m = 15\nwindow_length_m = 20\nfirst_ping_s = 0.5\n")}) {
    SCOPED_TRACE(sensor);
    const Echoes hopping = echoes({}, swath_seabed + on_waypoints + sensor),
                 moving = echoes({}, swath_seabed + on_waypoints + sensor + "stop_and_hop = false\n");
    EXPECT_GT(hopping.total(), 0);
    EXPECT_EQ(hopping.energy, moving.energy);
  }
}

// The separate receiver and its intervals have the energies of one apex if hardly anything moves.
TEST_F(MotionWithinPing, OfASlowCarrierIsNearlyThatOfStopAndHop) {
  const Rates slow{.roll_deg_s = 0.05, .ahead_m_s = 1e-3};
  const std::string scene = swath_seabed + on_waypoints + swath_sonar(""),
                    in_motion = scene + "stop_and_hop = false\nmotion_step_beams = 1e-4\n";
  const Echoes hopping = echoes(slow, scene), moving = echoes(slow, in_motion);
  EXPECT_GT(survey(slow, in_motion)->sensors[0].sensor->transmissions(), 1u);
  EXPECT_LT(echo_distance(moving, hopping), 3e-3);
}

TEST_F(MotionWithinPing, ConvergesAsIntervalsShrink) {
  const Rates rolling{.roll_deg_s = 20, .pitch_deg_s = 5, .ahead_m_s = 3};
  const auto with_step = [&](double beams) {
    return echoes(rolling,
                  swath_seabed + on_waypoints +
                      swath_sonar(fmt::format("stop_and_hop = false\nmotion_step_beams = {}\n", beams)));
  };
  const Echoes finest = with_step(0.01);
  double before = 0;
  for (const double step : {0.16, 0.08, 0.04}) {
    const double error = echo_distance(with_step(step), finest);
    SCOPED_TRACE(fmt::format("step {} beams: {}", step, error));
    if (before > 0) {
      EXPECT_LT(error, 0.65 * before);
    }
    before = error;
  }
  EXPECT_LT(before, 0.02);
  EXPECT_GT(echo_distance(echoes(rolling, swath_seabed + on_waypoints + swath_sonar("")), finest), 0.2);
}

// The receiver of a swath_sonar is wide along the track, so that pitch and yaw between transmission and
// reception lose no energy.
TEST_F(MotionWithinPing, AlongTheTrackLosesNoEnergyOfAMultibeam) {
  for (const Rates& rates : {Rates{.pitch_deg_s = 60}, Rates{.yaw_deg_s = 60}}) {
    const std::string scene = swath_seabed + on_waypoints + swath_sonar("");
    const double hopping = echoes(rates, scene).total(),
                 moving = echoes(rates, scene + "stop_and_hop = false\nmotion_step_beams = 0.2\n").total();
    EXPECT_NEAR(moving, hopping, 0.02 * hopping);
  }
}

constexpr double target_ahead_m = 60;

/// A small sphere ahead, which a sonar sees that travels towards it or turns.
std::string target_scene(const std::string& sensor) {
  return still_water() + lambert_material("steel", -10) +
         fmt::format(
             "[[objects]]\nname = \"target\"\nshape = \"sphere\"\nradius_m = 0.05\n"
             "position_m = [0, {}, 20]\n",
             target_ahead_m) +
         on_waypoints + sensor;
}

std::string imaging_sonar(const std::string& more) {
  return "[[sensors]]\nname = \"sonar\"\nkind = \"imaging\"\nbeams = 31\nhorizontal_deg = 31\n"
         "vertical_deg = 10\nrange_min_m = 50\nrange_max_m = 70\nsamples = 2000\nfirst_ping_s = 0.1\n" +
         more;
}

struct EchoCentroid {
  double range_m = 0, beam = 0;
};
EchoCentroid echo_centroid(const Echoes& echoes) {
  EchoCentroid sum;
  for (std::size_t beam = 0; beam < echoes.beams; ++beam)
    for (std::size_t k = 0; k < echoes.samples; ++k) {
      const double energy = echoes.at(0, beam, k);
      sum.range_m += energy * (echoes.first_m(k) + echoes.last_m(k)) / 2;
      sum.beam += energy * double(beam);
    }
  return {sum.range_m / echoes.total(), sum.beam / echoes.total()};
}

// Signals with phase have exact delays. Their envelope is the oracle for the range of the energies.
TEST_F(MotionWithinPing, GivesAPointTargetTheDelayOfItsSignal) {
  const Rates fast{.ahead_m_s = 15};
  const std::string array =
      "[[sensors]]\nname = \"array\"\nkind = \"array\"\nfrequency_khz = 30\nbandwidth_khz = 10\n"
      "pulse_length_us = 400\nrange_min_m = 50\nrange_max_m = 70\nhorizontal_deg = 20\nvertical_deg = 10\n"
      "receivers_m = [[0, 0, 0]]\nfirst_ping_s = 0.1\nstop_and_hop = false\n";
  folder.write("track.csv", track_file(fast));
  const SceneDescription description = read_scene_file(folder.write("scene.toml", target_scene(array)));
  const std::unique_ptr<const Survey> opened = open_survey(description, Facets::merged);
  SimulationStats stats;
  const std::vector<Recording> recordings = simulate(*opened, request_of(description.run), stats);
  const ElementSignals signals = element_signals_of(recordings.at(0));
  double sum = 0, time_s = 0;
  for (std::size_t k = 0; k < signals.samples(); ++k) {
    const double power = std::norm(signals.channel(0, 0)[k]);
    sum += power;
    time_s += power * signals.sampling.time_s(k);
  }
  const double delay_s = time_s / sum - 200e-6;  // the middle of the pulse

  const double moving_m =
                   echo_centroid(echoes(fast, target_scene(imaging_sonar(
                                                  "stop_and_hop = false\nmotion_step_beams = 0.005\n"))))
                       .range_m,
               hopping_m = echo_centroid(echoes(fast, target_scene(imaging_sonar("")))).range_m;
  // Transmission at 1.5 m, and reception 15 m/s * 78 ms later.
  EXPECT_NEAR(hopping_m, target_ahead_m - 1.5 - 0.05, 0.02);
  EXPECT_NEAR(hopping_m - moving_m, 15 * delay_s / 2, 0.005);
  // The signal of the rough sphere is one realisation, whose echo_centroid varies by its radius.
  EXPECT_NEAR(moving_m, delay_s * water_speed_m_s / 2, 0.05);
}

TEST_F(MotionWithinPing, TurnsBeamsByTheHeadingAtReception) {
  const Rates turning{.yaw_deg_s = 40};
  const double at_transmission_deg = 4;
  const double beam_at_transmission = 15 - at_transmission_deg,
               turned_deg = 40 * 2 * (target_ahead_m - 0.05) / water_speed_m_s;
  const EchoCentroid hopping = echo_centroid(echoes(turning, target_scene(imaging_sonar("")))),
                     moving = echo_centroid(
                         echoes(turning, target_scene(imaging_sonar("stop_and_hop = false\n"))));
  EXPECT_NEAR(hopping.beam, beam_at_transmission, 0.5);
  EXPECT_NEAR(moving.beam, beam_at_transmission - turned_deg, 0.5);
}

// Each step of the head is one beam, and several transmissions.
TEST_F(MotionWithinPing, OfAScanningHeadHasOneRowPerStep) {
  const std::string head =
      "[[sensors]]\nname = \"head\"\nkind = \"scanning\"\nscan_deg = 30\nstep_deg = 10\nbeam_horizontal_deg "
      "= 10\n"
      "beam_vertical_deg = 30\nrange_min_m = 50\nrange_max_m = 70\nsamples = 100\nstep_interval_s = 0.1\n"
      "first_ping_s = 0.1\nstop_and_hop = false\n";
  folder.write("track.csv", track_file({.yaw_deg_s = 40}));
  multibeam_for_tests::run(folder, target_scene(head));
  const auto steps = csv_rows(folder / "out/head-steps.csv");
  ASSERT_EQ(steps.size(), read_echoes(folder / "out/echoes.nc").beams);
  for (std::size_t k = 0; k < steps.size(); ++k)
    EXPECT_NEAR(std::stod(steps[k].at("time_s")), 0.1 + 0.1 * double(k), 1e-9);
}

TEST_F(MotionWithinPing, WarnsAboutStopAndHop) {
  const auto warnings = [&](const Rates& rates, const std::string& more) {
    std::string all;
    const auto opened = survey(rates, swath_seabed + on_waypoints + swath_sonar(more));
    for (const std::string& warning : opened->scene.report.warnings) all += warning + "\n";
    return all;
  };
  // At 0.5 s the roll is 10 degrees, and the outermost beam meets the swath_seabed at 36 m, 48 ms there and
  // back.
  const Rates rolling{.roll_deg_s = 20};
  EXPECT_THAT(
      warnings(rolling, ""),
      HasSubstr("sensor 'swath' stands still during a ping (stop_and_hop = true), but at the reception of "
                "ping 0, beam 0 is displaced by 0.24 beam widths"));
  EXPECT_EQ(warnings(rolling, "stop_and_hop = false\n").find("stands still"), std::string::npos);
  EXPECT_EQ(warnings({.roll_deg_s = 5}, "").find("stands still"), std::string::npos);
  EXPECT_EQ(warnings({.ahead_m_s = 5}, "").find("stands still"), std::string::npos);
}

TEST_F(MotionWithinPing, OfARecordBeyondTheTrackIsAnError) {
  try {
    survey({.roll_deg_s = 1, .until_s = 0.54},
           swath_seabed + on_waypoints + swath_sonar("stop_and_hop = false\n"));
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("scene.toml:"));
    EXPECT_THAT(error.what(), HasSubstr("the record of the ping at 0.5 s ends at 0.55"));
    EXPECT_THAT(error.what(), HasSubstr("but the trajectory ends at 0.54 s"));
  }
}

// The rays of the beams follow the attitude at transmission and at reception, so that soundings lie on the
// swath_seabed at height 0.
TEST_F(MotionWithinPing, PlacesSoundingsOnTheSeabed) {
  for (const char* stabilisation :
       {"", "stabilisation = [\"roll\"]\n", "stabilisation = [\"roll\", \"pitch\", \"yaw\"]\n",
        "sector_edges_deg = [-60, -20, 20, 60]\nstabilisation = [\"roll\", \"pitch\", \"yaw\"]\n"}) {
    SCOPED_TRACE(stabilisation);
    folder.write("track.csv",
                 track_file({.roll_deg_s = 12, .pitch_deg_s = 4, .yaw_deg_s = 3, .ahead_m_s = 4}));
    const std::string scene =
        swath_seabed + on_waypoints +
        replaced(swath_sonar(stabilisation), "samples = 160", "samples = 1600\nspacing = \"distance\"") +
        "stop_and_hop = false\nmotion_step_beams = 0.02\n";
    multibeam_for_tests::run(folder, scene);
    const auto soundings = multibeam_for_tests::soundings_in(folder / "out/swath-soundings.csv");
    ASSERT_EQ(soundings.size(), 24u);
    for (const auto& sounding : soundings) EXPECT_NEAR(sounding.up, 0, 0.03) << sounding.beam;
    // At 0.5 s the boat is rolled by 6 degrees, with the starboard side down, so that all beams turn to port.
    const bool is_level = *stabilisation != 0;
    EXPECT_NEAR(soundings.front().east, -20 * std::tan(radians(is_level ? 46 : 52)), 0.7);
    EXPECT_NEAR(soundings.back().east, 20 * std::tan(radians(is_level ? 46 : 40)), 0.7);
  }
}

constexpr const char* three_sectors =
    "sector_edges_deg = [-60, -20, 20, 60]\nsector_tilts_deg = [-1, 0, 1]\n"
    "sector_frequencies_khz = [260, 320, 290]\n";

/// Middle of the sector of a transmission as steered, in the scene's frame.
glm::dvec3 sector_middle(const Sensor& sensor, const SteeredPose& pose, std::size_t transmission) {
  const SectorAxis axis = sensor.sector_axis(transmission);
  const double across = axis.across_rad + pose.across_rad, along = axis.along_rad + pose.along_rad;
  return pose.attitude *
         glm::dvec3(std::cos(along) * std::sin(across), std::sin(along), -std::cos(along) * std::cos(across));
}

TEST_F(MotionWithinPing, IsCompensatedBySteeringPerSector) {
  const Rates attitude{.roll_deg_s = 12, .pitch_deg_s = 10, .yaw_deg_s = 8};
  const auto pings = survey(attitude, swath_seabed + on_waypoints + swath_sonar(three_sectors) +
                                          "stabilisation = [\"roll\", \"pitch\"]\n");
  const SensorPings& of = pings->sensors[0];
  const Sensor& sensor = *of.sensor;
  ASSERT_EQ(sensor.transmissions(), 3u);
  // At 0.5 s: roll 6, pitch 5, heading 4 degrees.
  const double heading_rad = radians(4);
  const glm::dvec3 ahead(std::sin(heading_rad), std::cos(heading_rad), 0);
  for (std::size_t sector = 0; sector < 3; ++sector) {
    const SteeredPose& pose = of.transmission_pose(0, sector);
    EXPECT_NEAR(degrees(pose.across_rad), 6, 1e-9);
    const glm::dvec3 middle = sector_middle(sensor, pose, sector);
    EXPECT_NEAR(degrees(std::asin(glm::dot(middle, ahead))), double(sector) - 1, 1e-9) << sector;
  }
  // Nadir needs the negative pitch, and outer sectors less.
  EXPECT_NEAR(degrees(of.transmission_pose(0, 1).along_rad), -5, 1e-9);
  EXPECT_LT(std::abs(degrees(of.transmission_pose(0, 0).along_rad)), 4.9);
}

TEST_F(MotionWithinPing, OfYawIsSteeredToTheMeanHeading) {
  const auto pings = survey({.yaw_deg_s = 8}, swath_seabed + on_waypoints + swath_sonar(three_sectors) +
                                                  "stabilisation = [\"yaw\"]\nstabilisation_heading_s = 3\n");
  // The track begins at 0 s, with a heading of 0 degrees.
  const SensorPings& of = pings->sensors[0];
  double sum_sin = 0, sum_cos = 0;
  for (int k = 0; k <= 20; ++k) {
    const double time_s = std::max(0.5 + 3 * (k / 20.0 - 0.5), 0.0);
    sum_sin += std::sin(radians(8 * time_s));
    sum_cos += std::cos(radians(8 * time_s));
  }
  const double heading_rad = std::atan2(sum_sin, sum_cos);
  EXPECT_GT(degrees(heading_rad), 4.5);
  for (std::size_t sector = 0; sector < 3; ++sector) {
    const glm::dvec3 middle = sector_middle(*of.sensor, of.transmission_pose(0, sector), sector);
    EXPECT_NEAR(
        degrees(std::asin(glm::dot(middle, glm::dvec3(std::sin(heading_rad), std::cos(heading_rad), 0)))),
        double(sector) - 1, 1e-9)
        << sector;
  }
}

// Neighbouring beams of equal distances overlap. The transmitter of a separate receiver insonifies each
// place once.
TEST_F(MotionWithinPing, TransmitsOnceIntoBeamsThatOverlap) {
  for (const char* beams : {"spacing = \"distance\"\n", "beam_angles_deg = [-30, -28, -20, 0, 1, 30]\n"}) {
    SCOPED_TRACE(beams);
    std::string sensor = swath_sonar("");
    if (std::string(beams).starts_with("beam_angles"))
      sensor = replaced(sensor, "beams = 24\nswath_deg = 92\n", beams);
    else
      sensor += beams;
    const Echoes alone = echoes({}, swath_seabed + on_waypoints + sensor),
                 separate =
                     echoes({}, swath_seabed + on_waypoints + sensor + "receiver_arm_m = [0, 1e-6, 0]\n");
    EXPECT_LT(echo_distance(separate, alone), 1e-4);
  }
}

}  // namespace
}  // namespace tubefoot
