// SPDX-License-Identifier: GPL-3.0-or-later
// Tests sensors: order and extent of beams, range bins, tubes, mountings and lever arms, and rejected
// descriptions.

#include "sensors/model/sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "fixtures/world/recordings.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/kinds/kind_didson.hpp"
#include "sensors/kinds/kind_sidescan.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

using samples::grid;

glm::dvec3 unit(GridPoint ray) { return glm::normalize(glm::dvec3(ray.x, ray.y, ray.z)); }

glm::dvec3 middle_of(const TubeSet& set, std::size_t tube) {
  glm::dvec3 sum(0);
  for (const auto corner : set.tubes[tube]) sum += unit(set.rays[corner]);
  return glm::normalize(sum);
}

double azimuth_deg(glm::dvec3 v) { return std::atan2(v.x, v.y) / degree; }
double elevation_deg(glm::dvec3 v) { return std::asin(v.z) / degree; }

TEST(Didson, BeamZeroIsThePortMostAndBeamsAreEqualCells) {
  const auto sensor = make_sensor(samples::camera());
  ASSERT_EQ(sensor->beams().size(), 96u);
  EXPECT_NEAR(sensor->beams().front().azimuth_rad / degree, -14.5 + 29.0 / 192, 1e-12);
  EXPECT_NEAR(sensor->beams().back().azimuth_rad / degree, 14.5 - 29.0 / 192, 1e-12);
  const TubeSet set = sensor->tubes(Pose{}, grid);
  ASSERT_EQ(set.tubes.size(), 96u);
  ASSERT_EQ(sensor->beam_of_tube().size(), 96u);
  for (std::size_t tube = 0; tube < 96; ++tube) {
    const std::size_t beam = sensor->beam_of_tube()[tube];
    EXPECT_EQ(beam, tube);
    EXPECT_NEAR(azimuth_deg(middle_of(set, tube)), sensor->beams()[beam].azimuth_rad / degree, 1e-6);
    EXPECT_NEAR(elevation_deg(middle_of(set, tube)), 0, 1e-6);
    for (const auto corner : set.tubes[tube]) {
      const glm::dvec3 ray = unit(set.rays[corner]);
      EXPECT_NEAR(std::abs(azimuth_deg(ray) - sensor->beams()[beam].azimuth_rad / degree), 29.0 / 192, 1e-6);
      EXPECT_NEAR(std::abs(elevation_deg(ray)), 7, 1e-6);
    }
  }
  EXPECT_LT(middle_of(set, 0).x, 0);
  EXPECT_GT(middle_of(set, 95).x, 0);
  EXPECT_GT(middle_of(set, 0).y, 0);
}

TEST(Didson, SamplesCoverTheWindowAndTubesReachItsEnd) {
  const auto sensor = make_sensor(samples::camera());
  EXPECT_EQ(sensor->frequency_khz(), 1800);
  EXPECT_DOUBLE_EQ(sensor->samples().first_m, 0.84);
  EXPECT_DOUBLE_EQ(sensor->samples().step_m, 5.0 / 512);
  EXPECT_EQ(sensor->samples().count, 512);
  EXPECT_NEAR(sensor->tubes(Pose{}, grid).reach, 5.84 * std::exp2(20), 1e-3);
}

TEST(Didson, TubesCoverWhatTransmitterAndReceiverBothLookAt) {
  SensorDescription description = samples::camera();
  auto& didson = description.kind.edit<DidsonDescription>();
  didson.transmit_horizontal_deg = 10;
  didson.transmit_vertical_deg = 20;  // more than the receiver's 14
  const auto sensor = make_sensor(description);
  const TubeSet set = sensor->tubes(Pose{}, grid);
  EXPECT_EQ(sensor->beams().size(), 96u);
  ASSERT_EQ(sensor->beam_of_tube().size(), set.tubes.size());
  EXPECT_EQ(set.tubes.size(), 34u);  // 10 degrees in beams of 29/96: 16 and a half to each side
  double widest = 0;
  for (std::size_t tube = 0; tube < set.tubes.size(); ++tube) {
    const BeamAxis& beam = sensor->beams()[sensor->beam_of_tube()[tube]];
    for (const auto corner : set.tubes[tube]) {
      const glm::dvec3 ray = unit(set.rays[corner]);
      EXPECT_LE(std::abs(azimuth_deg(ray) - beam.azimuth_rad / degree), 29.0 / 192 + 1e-6);
      EXPECT_NEAR(std::abs(elevation_deg(ray)), 7, 1e-6);
      widest = std::max(widest, std::abs(azimuth_deg(ray)));
    }
  }
  EXPECT_NEAR(widest, 5, 1e-6);
}

TEST(Didson, WideBeamsAndHighFansAreSeveralTubesOfOneBeam) {
  SensorDescription description = samples::camera(4);
  auto& didson = description.kind.edit<DidsonDescription>();
  didson.horizontal_deg = 360;
  didson.vertical_deg = 100;
  const auto sensor = make_sensor(description);
  const TubeSet set = sensor->tubes(Pose{}, grid);
  ASSERT_EQ(sensor->beam_of_tube().size(), set.tubes.size());
  for (std::size_t tube = 0; tube < set.tubes.size(); ++tube) {
    const double centre = sensor->beams()[sensor->beam_of_tube()[tube]].azimuth_rad / degree;
    EXPECT_LT(std::abs(azimuth_deg(middle_of(set, tube)) - centre), 45);
  }
}

TEST(Sidescan, PortFanLooksToNegativeXAndStarboardMirrorsItRayByRay) {
  const auto sensor = make_sensor(samples::sidescan());
  ASSERT_EQ(sensor->beams().size(), 2u);
  EXPECT_NEAR(sensor->beams()[0].azimuth_rad / degree, -90, 1e-12);
  EXPECT_NEAR(sensor->beams()[1].azimuth_rad / degree, 90, 1e-12);
  EXPECT_NEAR(sensor->beams()[0].elevation_rad / degree, -43.5, 1e-12);
  const TubeSet set = sensor->tubes(Pose{}, grid);
  ASSERT_EQ(set.tubes.size() % 2, 0u);
  const std::size_t tubes = set.tubes.size() / 2, rays = set.rays.size() / 2;
  for (std::size_t tube = 0; tube < 2 * tubes; ++tube) {
    EXPECT_EQ(sensor->beam_of_tube()[tube], tube < tubes ? 0u : 1u);
    EXPECT_LT(middle_of(set, tube).x * (tube < tubes ? -1 : 1), 1);
    EXPECT_GT(middle_of(set, tube).x * (tube < tubes ? -1 : 1), 0);
    EXPECT_LT(middle_of(set, tube).z, 0);
  }
  for (std::size_t ray = 0; ray < rays; ++ray) {
    const GridPoint port = set.rays[ray], starboard = set.rays[rays + ray];
    EXPECT_EQ(port, (GridPoint{-starboard.x, starboard.y, starboard.z}));
  }
}

TEST(Sidescan, FanKeepsItsAlongTrackWidthAtEveryDepression) {
  SensorDescription description = samples::sidescan();
  auto& fan = description.kind.edit<SidescanDescription>();
  fan.along_track_deg = 1;
  const auto sensor = make_sensor(description);
  const TubeSet set = sensor->tubes(Pose{}, grid);
  double shallowest = 90, steepest = 0;
  for (const Tube& tube : set.tubes) {
    for (std::size_t k = 0; k < 4; ++k) {
      const glm::dvec3 a = unit(set.rays[tube[k]]), b = unit(set.rays[tube[(k + 1) % 4]]);
      EXPECT_NEAR(std::abs(std::asin(a.y)) / degree, 0.5, 0.5 * 4.6e-5);
      const double depression = std::atan2(-a.z, std::abs(a.x)) / degree;
      shallowest = std::min(shallowest, depression);
      steepest = std::max(steepest, depression);
      // The wall between two corners bulges by at most the tolerance (sensors/model/angles.hpp).
      if (a.y * b.y > 0) {
        EXPECT_LT(std::abs(std::tan(std::asin(glm::normalize(a + b).y))) / std::tan(0.5 * degree) - 1,
                  4.51e-5);
      }
    }
  }
  EXPECT_NEAR(shallowest, 2, 1e-6);
  EXPECT_NEAR(steepest, 85, 1e-6);
}

TEST(Sidescan, SamplingFrequencyMakesSamplesOfTheWatersSoundSpeed) {
  SensorDescription description = samples::sidescan();
  auto& fan = description.kind.edit<SidescanDescription>();
  fan.sampling_frequency_khz = 15;
  EXPECT_THROW(make_sensor(description), std::invalid_argument);
  const auto sensor = make_sensor(in_water(description, 1500));  // 5 cm: 990 of them from 0.5 to 50 m
  EXPECT_DOUBLE_EQ(sensor->samples().step_m, 0.05);
  EXPECT_EQ(sensor->samples().count, 990);
  EXPECT_DOUBLE_EQ(sensor->samples().first_m, 0.5);
  const auto slower = make_sensor(in_water(description, 1440))->samples();  // 1031.25 of 4.8 cm
  EXPECT_DOUBLE_EQ(slower.step_m, 0.048);
  EXPECT_EQ(slower.count, 1031);
  for (const double frequency_khz : {1e-3, 1e4}) {
    fan.sampling_frequency_khz = frequency_khz;
    EXPECT_THROW(in_water(description, 1500), InputError);
  }
  const SensorDescription camera = samples::camera();
  EXPECT_EQ(make_sensor(in_water(camera, 1400))->samples().count, 512);
}

TEST(Sidescan, AxisOfItsPatternsMayLieApartFromTheFansMiddle) {
  SensorDescription description = samples::sidescan();
  description.transmit.pattern = description.receive.pattern = "gaussian";
  description.transmit.angle = description.receive.angle = "elevation";
  description.transmit.width_deg = description.receive.width_deg = 40;
  auto& fan = description.kind.edit<SidescanDescription>();
  fan.axis_depression_deg = 20;
  const auto sensor = make_sensor(description);
  EXPECT_NEAR(sensor->beams()[1].elevation_rad / degree, -20, 1e-12);
  const BeamPatterns patterns = sensor->patterns(Pose{}, 1500);
  for (const double side : {-1.0, 1.0}) {
    const auto towards = [&](double depression_deg) {
      return glm::dvec3(side * std::cos(depression_deg * degree), 0, -std::sin(depression_deg * degree));
    };
    const std::size_t beam = side < 0 ? 0 : 1;
    for (const auto& [depression_deg, power] : {std::pair{20, 1.0}, {40, 0.5}, {0, 0.5}}) {
      EXPECT_NEAR(patterns.transmit[beam].gain(towards(depression_deg)), power,
                  1e-9);  // -3 dB at half the width
      EXPECT_NEAR(patterns.receive[beam].gain(towards(depression_deg)), power, 1e-9);
    }
  }
}

TEST(Sidescan, FansThatMeetBelowShareTheirRays) {
  SensorDescription description = samples::sidescan();
  description.kind.edit<SidescanDescription>().depression_max_deg = 90;
  const TubeSet set = make_sensor(description)->tubes(Pose{}, grid);
  const std::size_t half = set.rays.size() / 2;
  EXPECT_EQ(set.rays[half - 1], set.rays.back());  // straight down: no gap and no overlap between the sides
  EXPECT_EQ(set.rays[half - 2], set.rays[set.rays.size() - 2]);
}

TEST(Mounting, TiltTurnsDownYawToStarboardRollStarboardDown) {
  const auto axes = [](double yaw, double tilt, double roll) {
    SensorDescription description = samples::camera();
    description.yaw_deg = yaw;
    description.tilt_deg = tilt;
    description.roll_deg = roll;
    return glm::mat3_cast(make_sensor(description)->pose_on(Pose{}).attitude);
  };
  const auto near = [](glm::dvec3 a, glm::dvec3 b) { return glm::length(a - b) < 1e-12; };
  const double s = std::sqrt(0.5);
  EXPECT_TRUE(near(axes(0, 45, 0)[1], {0, s, -s}));
  EXPECT_TRUE(near(axes(90, 0, 0)[1], {1, 0, 0}));
  EXPECT_TRUE(near(axes(0, 0, 45)[0], {s, 0, -s}));
  EXPECT_TRUE(near(axes(90, 45, 0)[1], {s, 0, -s}));  // tilt after yaw: about the axis of the turned sensor
}

TEST(Mounting, LeverArmTurnsWithTheCarrier) {
  SensorDescription description = samples::camera();
  description.lever_arm_m = {1, 2, 3};
  const auto sensor = make_sensor(description);
  const auto at = [&](double heading, double pitch) {
    return sensor->pose_on({{10, 20, 30}, attitude_from_angles(heading * degree, pitch * degree, 0)})
        .position_m;
  };
  const auto near = [](glm::dvec3 a, glm::dvec3 b) { return glm::length(a - b) < 1e-12; };
  EXPECT_TRUE(near(at(0, 0), {11, 22, 33}));
  EXPECT_TRUE(near(at(90, 0), {12, 19, 33}));  // heading east: forward is east, starboard is south
  EXPECT_TRUE(near(at(0, 90), {11, 17, 32}));  // bow up: forward is up, up is astern
}

TEST(Mounting, LookAtTurnsTheSensorToAPlaceWhateverItsCarrierDoes) {
  SensorDescription description = samples::camera();
  description.lever_arm_m = {0, 2, 0};
  description.receiver_arm_m = {{1, 2, 0}};
  description.look_at_m = {{30, 42, -11}};
  const auto near = [](glm::dvec3 a, glm::dvec3 b) { return glm::length(a - b) < 1e-12; };
  for (const double heading : {0.0, 1.0, -2.5}) {
    const auto sensor = make_sensor(description);
    const Pose carrier{{30, -4, 1}, attitude_from_angles(heading, 0.3, -0.2)};
    const Pose pose = sensor->pose_on(carrier);
    const glm::dvec3 way = glm::dvec3(30, 42, -11) - pose.position_m;
    EXPECT_TRUE(near(pose.attitude * glm::dvec3(0, 1, 0), glm::normalize(way)));
    EXPECT_NEAR((pose.attitude * glm::dvec3(1, 0, 0)).z, 0, 1e-12);  // upright
    EXPECT_EQ(sensor->receiver_pose_on(carrier).attitude, pose.attitude);
    EXPECT_NE(sensor->receiver_pose_on(carrier).position_m, pose.position_m);
  }
  description.roll_deg = 90;
  EXPECT_NEAR((make_sensor(description)->pose_on(Pose{}).attitude * glm::dvec3(1, 0, 0)).y, 0, 1);
  EXPECT_LT((make_sensor(description)->pose_on(Pose{}).attitude * glm::dvec3(1, 0, 0)).z, -0.9);
  // Straight down: the heading of the carrier.
  description.lever_arm_m = {0, 0, 0};
  description.roll_deg = 0;
  description.look_at_m = {{0, 0, -3}};
  const Pose down = make_sensor(description)->pose_on({{0, 0, 0}, attitude_from_angles(90 * degree, 0, 0)});
  EXPECT_TRUE(near(down.attitude * glm::dvec3(0, 1, 0), {0, 0, -1}));
  EXPECT_TRUE(near(down.attitude * glm::dvec3(1, 0, 0), {0, -1, 0}));
  description.look_at_m = {{0, 0, 0}};
  EXPECT_THROW(make_sensor(description)->pose_on(Pose{}), InputError);
}

TEST(Mounting, CarrierAndMountingTurnsAddUp) {
  SensorDescription description = samples::camera();
  description.yaw_deg = 30;
  const Pose pose = make_sensor(description)->pose_on({{0, 0, 0}, attitude_from_angles(60 * degree, 0, 0)});
  EXPECT_NEAR(glm::length(pose.attitude * glm::dvec3(0, 1, 0) - glm::dvec3(1, 0, 0)), 0, 1e-12);
}

TEST(Tubes, FollowThePose) {
  const auto sensor = make_sensor(samples::camera());
  const Pose pose{{1.25, -2.5, 3.0}, attitude_from_angles(90 * degree, -30 * degree, 0)};
  const TubeSet set = sensor->tubes(pose, grid);
  EXPECT_EQ(set.apex, grid.snap(pose.position_m));
  glm::dvec3 ahead(0);
  for (std::size_t tube = 0; tube < set.tubes.size(); ++tube) ahead += middle_of(set, tube);
  EXPECT_LT(glm::length(glm::normalize(ahead) - glm::dvec3(std::cos(30 * degree), 0, -0.5)), 1e-8);
  // Beam 0, port, looks to the north of east.
  EXPECT_GT(middle_of(set, 0).y, 0.2);
  EXPECT_EQ(set, sensor->tubes(pose, grid));
}

TEST(MakeSensor, RefusesWhatMakesNoSonar) {
  const auto refused_camera = [](auto change) {
    SensorDescription description = samples::camera();
    change(description.kind.edit<DidsonDescription>());
    EXPECT_THROW(make_sensor(description), std::invalid_argument);
  };
  refused_camera([](DidsonDescription& d) { d.beams = 0; });
  refused_camera([](DidsonDescription& d) { d.samples = 0; });
  refused_camera([](DidsonDescription& d) { d.horizontal_deg = 0; });
  refused_camera([](DidsonDescription& d) { d.horizontal_deg = 361; });
  refused_camera([](DidsonDescription& d) { d.vertical_deg = 180; });
  refused_camera([](DidsonDescription& d) { d.vertical_deg = std::nan(""); });
  refused_camera([](DidsonDescription& d) { d.window_start_m = -1; });
  refused_camera([](DidsonDescription& d) { d.window_length_m = 0; });
  const auto refused_sidescan = [](auto change) {
    SensorDescription description = samples::sidescan();
    change(description.kind.edit<SidescanDescription>());
    EXPECT_THROW(make_sensor(description), std::invalid_argument);
  };
  refused_sidescan([](SidescanDescription& d) { d.depression_max_deg = 95; });
  refused_sidescan([](SidescanDescription& d) { d.depression_min_deg = 85; });
  refused_sidescan([](SidescanDescription& d) { d.along_track_deg = 0; });
  refused_sidescan([](SidescanDescription& d) { d.range_max_m = d.range_min_m; });
  refused_sidescan([](SidescanDescription& d) { d.samples = -1; });
  SensorDescription no_ping = samples::camera();
  no_ping.pings = 0;
  EXPECT_THROW(make_sensor(no_ping), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
