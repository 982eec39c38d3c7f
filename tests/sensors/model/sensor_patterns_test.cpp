// SPDX-License-Identifier: GPL-3.0-or-later
// Tests beam patterns of sensors: axes of receive beams, patterns of sidescan sides, rotation with the
// pose, and pattern files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <glm/geometric.hpp>

#include "fixtures/world/recordings.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/model/pattern_file.hpp"
#include "sensors/model/sensor.hpp"

namespace tubefoot {
namespace {

using Kind = Directivity::Kind;

constexpr double sound_speed = 1500;

glm::dvec3 toward(double azimuth_deg, double elevation_deg = 0) {
  const double a = azimuth_deg * degree, e = elevation_deg * degree;
  return {std::cos(e) * std::sin(a), std::cos(e) * std::cos(a), std::sin(e)};
}

TEST(SensorPatterns, NoneByDefault) { EXPECT_FALSE(make_sensor(samples::camera())->has_patterns()); }

TEST(SensorPatterns, ReceiveBeamsOfACameraLookAlongTheirAxesAndHearTheWholeFan) {
  SensorDescription camera = samples::camera();
  camera.receive.pattern = "line";
  camera.receive.aperture_m = 0.1;
  const auto sensor = make_sensor(camera);
  const BeamPatterns patterns = sensor->patterns(Pose{}, sound_speed);
  ASSERT_EQ(patterns.receive.size(), 96u);
  ASSERT_EQ(patterns.fan_of_tube.size(), sensor->beam_of_tube().size());
  for (std::size_t beam = 0; beam < 96; ++beam) {
    const double azimuth = sensor->beams()[beam].azimuth_rad / degree;
    EXPECT_NEAR(patterns.receive[beam].gain(toward(azimuth)), 1, 1e-12);
    // 1.8 MHz and 0.1 m are 120 wavelengths, so that the first null is at a difference of 1/120 in the
    // cosine.
    const double null = std::asin(std::sin(azimuth * degree) + 1.0 / 120) / degree;
    EXPECT_NEAR(patterns.receive[beam].gain(toward(null)), 0, 1e-20);
  }
  for (const auto& [first, end] : patterns.beams_of_tube)
    EXPECT_EQ(std::pair(first, end), std::pair(0u, 96u));
  EXPECT_EQ(patterns.transmit.size(), 1u);
  ASSERT_EQ(patterns.transmit[0].beams.size(), 1u);
  EXPECT_EQ(patterns.transmit[0].beams[0].kind, Kind::uniform);
}

TEST(SensorPatterns, ShadingWeightsTheElementsOfALine) {
  SensorDescription camera = samples::camera();
  camera.receive.pattern = "line";
  camera.receive.aperture_m = 0.1;
  camera.receive.shading = 1;
  const BeamPatterns patterns = make_sensor(camera)->patterns(Pose{}, sound_speed);
  // The Hann window has half of the amplitude at the null of the uniform line, 1/120 in the cosine.
  const double null = std::asin(1.0 / 120 + std::sin(make_sensor(camera)->beams()[0].azimuth_rad)) / degree;
  EXPECT_NEAR(patterns.receive[0].gain(toward(null)), 0.25, 1e-12);
}

TEST(SensorPatterns, WithoutAReceivePatternABeamReceivesItsOwnTubes) {
  SensorDescription camera = samples::camera();
  camera.transmit.pattern = "gaussian";
  camera.transmit.angle = "elevation";
  camera.transmit.width_deg = 10;
  const auto sensor = make_sensor(camera);
  const BeamPatterns patterns = sensor->patterns(Pose{}, sound_speed);
  for (std::size_t tube = 0; tube < sensor->beam_of_tube().size(); ++tube) {
    const std::uint32_t beam = sensor->beam_of_tube()[tube];
    EXPECT_EQ(patterns.beams_of_tube[tube], std::pair(beam, beam + 1));
  }
  EXPECT_NEAR(patterns.transmit[0].gain(toward(13, 5)), 0.5, 1e-12);
  EXPECT_NEAR(patterns.transmit[0].gain(toward(-7, -5)), 0.5, 1e-12);
  EXPECT_NEAR(patterns.transmit[0].gain(toward(-7, 0)), 1, 1e-12);
}

TEST(SensorPatterns, TurnWithThePose) {
  SensorDescription camera = samples::camera();
  camera.transmit.pattern = "piston";
  camera.transmit.aperture_m = 0.02;
  const auto sensor = make_sensor(camera);
  const glm::dquat attitude = attitude_from_angles(30 * degree, -20 * degree, 5 * degree);
  const BeamPatterns level = sensor->patterns(Pose{}, sound_speed);
  const BeamPatterns turned = sensor->patterns(Pose{{0, 0, 0}, attitude}, sound_speed);
  for (const glm::dvec3 d : {toward(0), toward(3, 1), toward(-8, 4)})
    EXPECT_NEAR(turned.transmit[0].gain(attitude * d), level.transmit[0].gain(d), 1e-12);
}

TEST(SensorPatterns, SidescanFansHaveTheirOwnAxesAndDoNotHearEachOther) {
  SensorDescription description = samples::sidescan();
  description.receive.pattern = "line";
  description.receive.aperture_m = 0.5;
  description.transmit.pattern = "gaussian";
  description.transmit.angle = "elevation";
  description.transmit.width_deg = 40;
  const auto sensor = make_sensor(description);
  const BeamPatterns patterns = sensor->patterns(Pose{}, sound_speed);
  ASSERT_EQ(patterns.transmit.size(), 2u);
  for (std::size_t tube = 0; tube < sensor->beam_of_tube().size(); ++tube) {
    const std::uint32_t side = sensor->beam_of_tube()[tube];
    EXPECT_EQ(patterns.fan_of_tube[tube], side);
    EXPECT_EQ(patterns.beams_of_tube[tube], std::pair(side, side + 1));
  }
  for (const std::uint32_t side : {0u, 1u}) {
    const double sign = side == 0 ? -1 : 1;
    const auto down = [&](double depression_deg) { return toward(sign * 90, -depression_deg); };
    EXPECT_NEAR(patterns.transmit[side].gain(down(43.5)), 1, 1e-12);
    EXPECT_NEAR(patterns.transmit[side].gain(down(63.5)), 0.5, 1e-12);
    EXPECT_NEAR(patterns.transmit[side].gain(down(23.5)), 0.5, 1e-12);
    EXPECT_NEAR(patterns.receive[side].gain(down(10)), 1, 1e-12);
    EXPECT_NEAR(patterns.receive[side].gain(down(80)), 1, 1e-12);
    // Forward of the fan by the first null of 0.5 m at 455 kHz.
    const double null = sound_speed / 455e3 / 0.5;
    EXPECT_NEAR(patterns.receive[side].gain({sign * std::sqrt(1 - null * null), null, 0}), 0, 1e-20);
  }
}

class PatternFile : public testing::Test {
 protected:
  PatternTable read(const std::string& text) {
    std::ofstream(file) << text;
    return read_pattern_file(file);
  }
  std::string error_of(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }
  TestFolder folder;
  std::filesystem::path file = folder / "beam.csv";
};

TEST_F(PatternFile, IsReadWithCommentsAndMirroredAboutZero) {
  const PatternTable table = read("\xEF\xBB\xBF# measured\nangle_deg, level_db\r\n0,0\n\n2, -3\n5,-20\n");
  EXPECT_NEAR(table.level_db(2 * degree), -3, 1e-12);
  EXPECT_NEAR(table.level_db(-2 * degree), -3, 1e-12);
  EXPECT_NEAR(table.level_db(-9 * degree), -20, 1e-12);
  const PatternTable lopsided = read("angle_deg,level_db\n-1,-6\n2,-3\n");
  EXPECT_NEAR(lopsided.level_db(-2 * degree), -6, 1e-12);
}

TEST_F(PatternFile, MistakesAreReportedWithTheirLine) {
  using testing::HasSubstr;
  EXPECT_THAT(error_of(""), HasSubstr("is empty"));
  EXPECT_THAT(error_of("angle,level\n0,0\n"), HasSubstr(":1: expected the header line"));
  EXPECT_THAT(error_of("angle_deg,level_db\n0,0\n"), HasSubstr("expected at least two angles"));
  EXPECT_THAT(error_of("angle_deg,level_db\n0,0\n1,x\n"), HasSubstr(":3: level_db is 'x'"));
  EXPECT_THAT(error_of("angle_deg,level_db\n0,0\n1,nan\n"), HasSubstr(":3: level_db is 'nan'"));
  EXPECT_THAT(error_of("angle_deg,level_db\n1,0\n1,-1\n"),
              HasSubstr(":3: angle_deg is 1, but the previous angle is 1"));
  EXPECT_THAT(error_of("angle_deg,level_db\n0,0,0\n"), HasSubstr(":2: expected two fields"));
  EXPECT_THAT(error_of("angle_deg,level_db\n0,0\n200,-1\n"), HasSubstr(":3: angle_deg is 200"));
}

}  // namespace
}  // namespace tubefoot
