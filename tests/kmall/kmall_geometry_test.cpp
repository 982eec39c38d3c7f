// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the geometry of soundings: signs of rotations, closed forms of level, inclined and moving sonars, and
// the positions of the recordings.
#include "kmall/kmall_geometry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "fixtures/kmall_builder.hpp"
#include "fixtures/kmall_recordings.hpp"
#include "fixtures/test_folder.hpp"

namespace tubefoot {
namespace {

constexpr double speed_m_s = 1480, ping_s = 100;
const glm::dvec3 forward(1, 0, 0), starboard(0, 1, 0), down(0, 0, 1);

double difference(const glm::dmat3& a, const glm::dmat3& b) {
  double most = 0;
  for (int k = 0; k < 3; ++k) most = std::max(most, glm::length(a[k] - b[k]));
  return most;
}

/// Elementary rotations, in columns.
glm::dmat3 about_x(double deg) {
  const double c = std::cos(glm::radians(deg)), s = std::sin(glm::radians(deg));
  return {{1, 0, 0}, {0, c, s}, {0, -s, c}};
}
glm::dmat3 about_y(double deg) {
  const double c = std::cos(glm::radians(deg)), s = std::sin(glm::radians(deg));
  return {{c, 0, -s}, {0, 1, 0}, {s, 0, c}};
}
glm::dmat3 about_z(double deg) {
  const double c = std::cos(glm::radians(deg)), s = std::sin(glm::radians(deg));
  return {{c, s, 0}, {-s, c, 0}, {0, 0, 1}};
}
/// Roll, then pitch, then heading.
glm::dmat3 turned(double roll_deg, double pitch_deg, double heading_deg) {
  return about_z(heading_deg) * about_y(pitch_deg) * about_x(roll_deg);
}

TEST(KmallRotation, IsOrthogonalAndHasTheDocumentedSigns) {
  for (const double roll_deg : {-31.0, 0.0, 4.5})
    for (const double pitch_deg : {-17.0, 0.0, 2.5})
      for (const double heading_deg : {-90.0, 0.0, 177.92, 359.0}) {
        const glm::dmat3 r = rotation_of(roll_deg, pitch_deg, heading_deg);
        EXPECT_LT(difference(glm::transpose(r) * r, glm::dmat3(1)), 1e-14);
        EXPECT_NEAR(glm::determinant(r), 1, 1e-14);
        EXPECT_LT(difference(r, turned(roll_deg, pitch_deg, heading_deg)), 1e-14);
      }
  EXPECT_GT((rotation_of(5, 0, 0) * starboard).z, 0) << "positive roll: the starboard side is down";
  EXPECT_LT((rotation_of(0, 5, 0) * forward).z, 0) << "positive pitch: the bow is up";
  EXPECT_GT((rotation_of(0, 0, 5) * forward).y, 0) << "positive heading: the bow is to starboard";
  EXPECT_LT(glm::length(rotation_of(0, 0, 90) * forward - starboard), 1e-15);
}

TEST(KmallArm, TurnsThePhaseCentreWithTheMounting) {
  KmallMounting mounting{{1, 2, 3}, 0, 0, 180, {}};
  mounting.phase_centres_m = {{{0.1, 0.05, 0.01}, {0, 0.02, 0}, {-0.1, 0, 0.03}}};
  EXPECT_LT(glm::length(arm_of(mounting, 0) - glm::dvec3(0.9, 1.95, 3.01)), 1e-14);
  EXPECT_LT(glm::length(arm_of(mounting) - glm::dvec3(1, 1.98, 3)), 1e-14);
  EXPECT_LT(glm::length(arm_of(mounting, 2) - glm::dvec3(1.1, 2, 3.03)), 1e-14);
  EXPECT_THROW(arm_of(mounting, 3), std::out_of_range);
}

using MotionOf = std::function<KmallMotion(double time_s)>;

KmallMotion at_rest(double time_s) { return {time_s, 0, 0, 0, 0}; }

/// A sonar in isovelocity water with one sector, and the soundings of given points.
struct Sonar {
  KmallSurvey survey;
  KmallPing ping;

  Sonar(const KmallMounting& transmitter, const KmallMounting& receiver, const MotionOf& motion = at_rest) {
    survey.installation.transmitters[0] = transmitter;
    survey.installation.receivers[0] = receiver;
    for (int k = -30; k <= 30; ++k) survey.motion.push_back(motion(ping_s + 0.01 * k));
    ping.time_s = ping_s;
    ping.heading_deg = motion(ping_s).heading_deg;
    ping.sound_speed_m_s = speed_m_s;
    ping.sectors.resize(1);
  }
  std::optional<glm::dvec3> point_of(const KmallSounding& sounding) const {
    return recomputed(survey, ping, sounding,
                      {profile_at(survey, transducer_depth_m(survey, ping), ping.sound_speed_m_s), {}});
  }
  /// Apex of an array at a time, in the frame of the ping.
  glm::dvec3 apex(const KmallMounting& mounting, const MotionOf& motion, double time_s,
                  std::size_t part) const {
    const KmallMotion m = motion(time_s);
    return turned(m.roll_deg, m.pitch_deg, m.heading_deg - ping.heading_deg) *
               (mounting.position_m + turned(mounting.roll_deg, mounting.pitch_deg, mounting.heading_deg) *
                                          mounting.phase_centres_m.at(part)) +
           glm::dvec3(0, 0, m.heave_m - motion(ping_s).heave_m);
  }
  static glm::dvec3 axis(const KmallMounting& mounting, const KmallMotion& m, double heading_deg,
                         glm::dvec3 of) {
    return turned(m.roll_deg, m.pitch_deg, m.heading_deg - heading_deg) *
           (turned(mounting.roll_deg, mounting.pitch_deg, mounting.heading_deg) * of);
  }
  /// Sets the tilt of the sector, and returns the sounding, by which the point is observed.
  KmallSounding observe(glm::dvec3 point_m, const MotionOf& motion = at_rest) {
    const KmallMounting &tx = *survey.installation.transmitters[0], &rx = *survey.installation.receivers[0];
    KmallSector& sector = ping.sectors[0];
    const double sent_s = ping_s + sector.delay_s;
    const glm::dvec3 from = apex(tx, motion, sent_s, sector.sub_array);
    const double out_m = glm::distance(point_m, from);
    double time_s = 2 * out_m / speed_m_s;
    for (int round = 0; round < 20; ++round)
      time_s = (out_m + glm::distance(point_m, apex(rx, motion, sent_s + time_s, 1))) / speed_m_s;
    const glm::dvec3 to = apex(rx, motion, sent_s + time_s, 1);
    const auto sine = [](glm::dvec3 direction, glm::dvec3 axis_of) {
      return std::asin(glm::dot(glm::normalize(direction), axis_of));
    };
    sector.tilt_deg = glm::degrees(sine(point_m - from, axis(tx, motion(sent_s), ping.heading_deg, forward)));
    KmallSounding s;
    s.two_way_travel_time_s = time_s;
    s.angle_re_receiver_deg =
        -glm::degrees(sine(point_m - to, axis(rx, motion(sent_s + time_s), ping.heading_deg, starboard)));
    return s;
  }
};

KmallMounting mounted(glm::dvec3 position_m, double roll_deg = 0, double pitch_deg = 0,
                      double heading_deg = 0) {
  return {position_m, roll_deg, pitch_deg, heading_deg, {}};
}

// Level sonar, one apex: the unit vector has the components sin(tilt) and -sin(angle) along the arrays.
TEST(KmallSoundings, OfALevelSonarHaveTheClosedForm) {
  constexpr double depth_m = 12;
  const glm::dvec3 apex_m(0.5, -0.25, 1);
  Sonar sonar(mounted(apex_m), mounted(apex_m));
  for (const double tilt_deg : {-3.0, 0.0, 0.75, 20.0})
    for (const double angle_deg : {-65.0, -10.0, 0.0, 45.0}) {
      SCOPED_TRACE(testing::Message() << tilt_deg << " " << angle_deg);
      const double t = std::sin(glm::radians(tilt_deg)), a = std::sin(glm::radians(angle_deg));
      const double vertical = std::sqrt(1 - t * t - a * a);
      const glm::dvec3 expected = apex_m + depth_m / vertical * glm::dvec3(t, -a, vertical);
      sonar.ping.sectors[0].tilt_deg = tilt_deg;
      KmallSounding s;
      s.angle_re_receiver_deg = angle_deg;
      s.two_way_travel_time_s = 2 * depth_m / vertical / speed_m_s;
      const glm::dvec3 point = sonar.point_of(s).value();
      EXPECT_LT(glm::distance(point, expected), 1e-5);
      if (tilt_deg == 0) continue;
      sonar.ping.sectors[0].tilt_deg = -tilt_deg;
      EXPECT_GT(glm::distance(*sonar.point_of(s), expected), 0.1) << "the sign of the tilt has no effect";
    }
  // Below the sonar, the forward distance is the depth times the tangent of the tilt.
  sonar.ping.sectors[0].tilt_deg = 20;
  KmallSounding below;
  below.two_way_travel_time_s = 2 * depth_m / std::cos(glm::radians(20.0)) / speed_m_s;
  EXPECT_NEAR(sonar.point_of(below)->x - apex_m.x, depth_m * std::tan(glm::radians(20.0)), 1e-5);
}

TEST(KmallSoundings, OfSeparateArraysAreTheObservedPoints) {
  Sonar sonar(mounted({1.25, -0.5, 0.75}), mounted({-0.5, 0.75, 1.25}));
  for (const glm::dvec3 point :
       {glm::dvec3(0, 0, 9), glm::dvec3(1, -14, 10), glm::dvec3(-2, 11, 8), glm::dvec3(0.4, 0.1, 3)}) {
    const KmallSounding s = sonar.observe(point);
    EXPECT_LT(glm::distance(sonar.point_of(s).value(), point), 1e-5);
    Sonar without = sonar;
    without.survey.installation.receivers[0]->position_m = {1.25, -0.5, 0.75};
    EXPECT_GT(glm::distance(without.point_of(s).value(), point), 0.1) << "the lever arm has no effect";
  }
}

TEST(KmallSoundings, OfAnInclinedSonarMountedBackwardsAreTheObservedPoints) {
  const MotionOf inclined = [](double time_s) { return KmallMotion{time_s, 6, -4, 215, 0.5}; };
  KmallMounting tx = mounted({-0.5, -0.1, 1.7}, 0.5, 0.9, 177.92),
                rx = mounted({-0.3, 0.1, 1.7}, -2, -0.9, 357.9);
  tx.phase_centres_m = {{{0, -0.05, -0.01}, {0, 0.01, 0}, {0, 0.05, -0.01}}};
  rx.phase_centres_m[1] = {-0.01, 0, -0.006};
  for (const std::size_t part : {0u, 1u, 2u}) {
    Sonar sonar(tx, rx, inclined);
    sonar.ping.sectors[0].sub_array = part;
    for (const glm::dvec3 point : {glm::dvec3(0.5, 0, 9), glm::dvec3(-0.4, -12, 8), glm::dvec3(1, 13, 9)}) {
      const KmallSounding s = sonar.observe(point, inclined);
      EXPECT_LT(glm::distance(sonar.point_of(s).value(), point), 1e-5);
      Sonar level = sonar;
      for (KmallMotion& m : level.survey.motion) m.roll_deg = 0;
      EXPECT_GT(glm::distance(level.point_of(s).value(), point), 0.1) << "the roll has no effect";
    }
  }
}

// The attitude at transmission and reception differs: 0.03 s pass, in which the ship rolls by 1 degree.
TEST(KmallSoundings, OfAMovingShipUseTheAttitudeOfBothTimes) {
  const MotionOf moving = [](double time_s) {
    const double t = time_s - ping_s;
    return KmallMotion{time_s, 1 + 30 * t, -2 - 12 * t, 45 + 8 * t, 0.5 * t};
  };
  const KmallMounting tx = mounted({2, 1, 1.5}), rx = mounted({1.5, 1.5, 1.5});
  Sonar sonar(tx, rx, moving);
  for (const double delay_s : {0.0, 0.02}) {
    sonar.ping.sectors[0].delay_s = delay_s;
    for (const glm::dvec3 point : {glm::dvec3(2, 0, 20), glm::dvec3(1, -18, 20), glm::dvec3(3, 25, 20)}) {
      const KmallSounding s = sonar.observe(point, moving);
      EXPECT_LT(glm::distance(sonar.point_of(s).value(), point), 1e-4);
      Sonar still = sonar;
      for (KmallMotion& m : still.survey.motion) m.roll_deg = 1;
      EXPECT_GT(glm::distance(still.point_of(s).value(), point), 0.1);
    }
  }
}

// Straight down, the time is the integral of dz / c: ln(c2 / c1) / gradient per way.
TEST(KmallSoundings, InStratifiedWaterHaveTheTravelTimeOfTheLayers) {
  Sonar sonar(mounted({0, 0, 1}), mounted({0, 0, 1}));
  sonar.survey.profile = {{0, 1400}, {0.5, 1400}, {11, 1580}, {50, 1580}};
  const double gradient_per_s = (1580 - speed_m_s) / 10;  // from the transducer to 11 m
  KmallSounding s;
  s.two_way_travel_time_s = 2 * (std::log(1580 / speed_m_s) / gradient_per_s + 4 / 1580.0);
  EXPECT_LT(glm::distance(sonar.point_of(s).value(), {0, 0, 15}), 1e-5);
  // Snell's law with one interface: the sine of the angle is proportional to the sound speed.
  sonar.survey.profile = {{1.5, speed_m_s}, {1.52, 1500}, {50, 1500}};
  s.angle_re_receiver_deg = -40;
  s.two_way_travel_time_s = 0.02;
  const glm::dvec3 point = sonar.point_of(s).value();
  const double sine = std::sin(glm::radians(40.0)) * 1500 / speed_m_s;
  EXPECT_NEAR(std::atan2(point.y, point.z - 1), std::asin(sine), 2e-3);
  EXPECT_GT(std::atan2(point.y, point.z - 1), std::asin(sine) - 2e-3);
  EXPECT_GT(std::atan2(point.y, point.z - 1), glm::radians(40.2));
}

TEST(KmallSoundings, WithoutAttitudeOrPointAreEmpty) {
  Sonar sonar(mounted({0, 0, 1}), mounted({0, 0, 1}));
  KmallSounding s;
  s.two_way_travel_time_s = 0.01;
  EXPECT_TRUE(sonar.point_of(s));
  s.two_way_travel_time_s = 5;
  EXPECT_FALSE(sonar.point_of(s)) << "no attitude at reception";
  s.two_way_travel_time_s = 0.01;
  s.angle_re_receiver_deg = 80;
  sonar.ping.sectors[0].tilt_deg = 80;
  EXPECT_FALSE(sonar.point_of(s)) << "cones that do not meet";
}

TEST(KmallProfile, BeginsAtTheTransducerWithTheMeasuredSpeed) {
  KmallSurvey survey;
  survey.profile = {{0, 1490}, {2, 1491}, {2, 1400}, {4, 1492}};
  const SoundSpeedProfile profile = profile_at(survey, 1.5, 1480);
  EXPECT_EQ(profile.at(0.5), 1480);
  EXPECT_EQ(profile.at(1.5), 1480);
  EXPECT_NEAR(profile.at(1.75), (1480 + 1491) / 2.0, 1e-9);
  EXPECT_EQ(profile.at(4), 1492);
  EXPECT_EQ(profile.at(100), 1492);
  survey.profile.clear();
  EXPECT_TRUE(profile_at(survey, 1.5, 1480).is_constant());
  EXPECT_EQ(profile_at(survey, 1.5, 1480).at(50), 1480);
}

TEST(KmallDepth, OfTheTransducerFollowsPitchAndWaterLine) {
  const MotionOf pitched = [](double time_s) { return KmallMotion{time_s, 0, 10, 70, 3}; };
  Sonar sonar(mounted({-2, 0.5, 1.5}), mounted({0, 0, 0}), pitched);
  sonar.ping.waterline_m = 0.25;
  const double expected_m =
      1.5 * std::cos(glm::radians(10.0)) + 2 * std::sin(glm::radians(10.0)) - 0.25;  // the stern is down
  EXPECT_NEAR(transducer_depth_m(sonar.survey, sonar.ping), expected_m, 1e-12);
}

double percentile_95_m(const KmallSurvey& survey) { return residuals_of(survey).percentile_95_m; }

/// Expects small residuals, and large ones after changes of the signs and of the mounting.
void expect_recomputed(const std::filesystem::path& file) {
  SCOPED_TRACE(file.string());
  KmallSurvey survey = read_kmall_survey(file, false);
  std::size_t valid = 0;
  for (const KmallPing& ping : survey.pings)
    for (const KmallSounding& s : ping.soundings) valid += s.is_valid;
  const KmallResiduals residuals = residuals_of(survey);
  EXPECT_GT(valid, 1000u);
  EXPECT_GE(residuals.soundings, valid * 4 / 5);
  EXPECT_LT(residuals.percentile_95_m, 0.05);
  EXPECT_LT(residuals.median_m, 0.01);

  KmallSurvey other = survey;
  for (KmallPing& ping : other.pings)
    for (KmallSector& sector : ping.sectors) sector.tilt_deg = -sector.tilt_deg;
  EXPECT_GT(percentile_95_m(other), 0.1) << "the sign of the tilt has no effect";
  other = survey;
  other.installation.transmitters[0]->position_m.x = 0;
  EXPECT_GT(percentile_95_m(other), 0.1) << "the lever arm has no effect";
  other = survey;
  for (KmallPing& ping : other.pings)
    for (KmallSounding& s : ping.soundings) s.angle_re_receiver_deg = -s.angle_re_receiver_deg;
  EXPECT_GT(percentile_95_m(other), 0.1) << "the side has no effect";
}

TEST(KmallResiduals, OfTheRepositorysRecordingAreBelowFiveCentimetres) {
  expect_recomputed(repository_recording);
}

TEST(KmallResiduals, OfFurtherRecordingsAreBelowFiveCentimetres) {
  if (shared_recordings().empty()) GTEST_SKIP() << no_recordings;
  EXPECT_EQ(shared_recordings().size(), 5u);
  for (const auto& file : shared_recordings()) expect_recomputed(file);
}

TEST(KmallResiduals, OfABuiltLineAreThoseOfItsNumbers) {
  const TestFolder folder;
  const kmall_for_tests::Line line = kmall_for_tests::two_modes();
  folder.write("line.kmall", line.soundings_file());
  KmallSurvey survey = read_kmall_survey(folder / "line.kmall", false);
  const KmallResiduals residuals = residuals_of(survey);
  EXPECT_EQ(residuals.soundings, 3u * 4 + 3 * 3);
  EXPECT_LT(residuals.percentile_95_m, 1e-4);
  // Without the heads, nothing can be recomputed.
  survey.installation.receivers[0].reset();
  EXPECT_EQ(residuals_of(survey).soundings, 0u);
}

}  // namespace
}  // namespace tubefoot
