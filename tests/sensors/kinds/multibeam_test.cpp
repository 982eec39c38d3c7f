// SPDX-License-Identifier: GPL-3.0-or-later
// Tests multibeams: sectors and axes of beams, equidistant beams, patterns of two crossed lines, and bottom
// detection on planes.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "fixtures/world/recordings.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/kinds/kind_multibeam.hpp"
#include "sensors/products/swath_soundings.hpp"

namespace tubefoot {
namespace {

using samples::grid;
using samples::unit;

SensorDescription multibeam(const MultibeamDescription& fan = {}) {
  SensorDescription description;
  description.name = "multibeam";
  description.kind = fan;
  return description;
}

double across_deg(glm::dvec3 v) { return std::atan2(v.x, -v.z) / degree; }

TEST(Multibeam, DefaultFanIsThatOfThe8101) {
  const auto sensor = make_sensor(multibeam());
  ASSERT_EQ(sensor->beams().size(), 101u);
  EXPECT_EQ(sensor->frequency_khz(), 240);
  for (std::size_t beam = 0; beam <= 100; ++beam)
    EXPECT_NEAR(across_angle_rad(sensor->beams()[beam]) / degree, -75 + 1.5 * double(beam), 1e-12);
  EXPECT_EQ(across_angle_rad(sensor->beams()[50]), 0);
  EXPECT_NEAR(sensor->beams()[0].azimuth_rad / degree, -90, 1e-12);
  EXPECT_NEAR(sensor->beams()[0].elevation_rad / degree, -15, 1e-12);
  EXPECT_NEAR(sensor->beams()[50].elevation_rad / degree, -90, 1e-12);
}

TEST(Multibeam, BeamsAreSectorsSideBySideFromPortToStarboard) {
  const auto sensor = make_sensor(multibeam());
  const TubeSet set = sensor->tubes(Pose{}, grid);
  ASSERT_EQ(set.tubes.size(), 101u);
  for (std::size_t tube = 0; tube < 101; ++tube) {
    EXPECT_EQ(sensor->beam_of_tube()[tube], tube);
    for (const auto corner : set.tubes[tube]) {
      const glm::dvec3 ray = unit(set.rays[corner]);
      EXPECT_NEAR(std::abs(across_deg(ray) - (-75 + 1.5 * double(tube))), 0.75, 1e-6);
      EXPECT_NEAR(std::abs(std::asin(ray.y)) / degree, 0.75, 0.75 * 4.6e-5);  // cone_tolerance
    }
  }
  EXPECT_EQ(set.rays.size(), 2u * 102);  // adjacent tubes share their rays: no gap
  EXPECT_LT(unit(set.rays[set.tubes[0][0]]).x, 0);
}

TEST(Multibeam, OfEqualDistanceMeetsALevelSeabedAtEvenSteps) {
  MultibeamDescription fan;
  fan.beams = 11;
  fan.swath_deg = 120;
  fan.spacing = "distance";
  const auto sensor = make_sensor(multibeam(fan));
  for (std::size_t beam = 0; beam <= 10; ++beam)
    EXPECT_NEAR(std::tan(across_angle_rad(sensor->beams()[beam])), std::sqrt(3) * (double(beam) - 5) / 5,
                1e-12);
  const TubeSet set = sensor->tubes(Pose{}, grid);
  for (std::size_t tube = 0; tube < 11; ++tube)
    for (const auto corner : set.tubes[tube])
      EXPECT_NEAR(
          std::abs(across_deg(unit(set.rays[corner])) - across_angle_rad(sensor->beams()[tube]) / degree),
          0.75, 1e-6);
}

TEST(Multibeam, ASingleBeamLooksStraightDownInSlicesOfOneBeam) {
  MultibeamDescription fan;
  fan.beams = 1;
  fan.beam_across_deg = 8;
  const auto sensor = make_sensor(multibeam(fan));
  EXPECT_EQ(across_angle_rad(sensor->beams()[0]), 0);
  EXPECT_EQ(sensor->beam_of_tube(), std::vector<std::uint32_t>(6, 0));
  double widest = 0;
  for (const GridPoint ray : sensor->tubes(Pose{}, grid).rays)
    widest = std::max(widest, std::abs(across_deg(unit(ray))));
  EXPECT_NEAR(widest, 4, 1e-6);
}

// Mills cross: a line along the track transmits, and one across the track receives and is steered.
TEST(Multibeam, PatternsOfALineAlongAndALineAcrossTheTrack) {
  SensorDescription description = multibeam();
  description.transmit.pattern = description.receive.pattern = "line";
  description.transmit.aperture_m = description.receive.aperture_m = 0.25;
  description.receive.angle = "elevation";
  const auto sensor = make_sensor(description);
  const BeamPatterns patterns = sensor->patterns(Pose{}, 1500, 0);
  const auto sinc2 = [](double x) {
    const double y = std::numbers::pi * x;
    return y == 0 ? 1 : std::pow(std::sin(y) / y, 2);
  };
  constexpr double length = 0.25 * 240e3 / 1500;  // wavelengths
  const auto towards = [](double across, double along) {
    return glm::dvec3(std::sin(across * degree) * std::cos(along * degree), std::sin(along * degree),
                      -std::cos(across * degree) * std::cos(along * degree));
  };
  ASSERT_EQ(patterns.receive.size(), 101u);
  for (const double across : {-60.0, 0.0, 33.0})
    for (const double along : {0.0, 0.8, 3.0})
      EXPECT_NEAR(patterns.transmit.at(0).gain(towards(across, along)),
                  sinc2(length * std::sin(along * degree)), 1e-12);
  for (const std::size_t beam : {10u, 50u, 87u})
    for (const double off : {0.0, 0.7, -4.0}) {
      const double axis = -75 + 1.5 * double(beam);
      EXPECT_NEAR(patterns.receive[beam].gain(towards(axis + off, 0)),
                  sinc2(length * (std::sin((axis + off) * degree) - std::sin(axis * degree))), 1e-12);
    }
  EXPECT_EQ(patterns.beams_of_tube.at(3), std::make_pair(0u, 101u));
}

TEST(Multibeam, RefusesWhatMakesNoSonar) {
  const auto refused = [](auto change) {
    MultibeamDescription fan;
    change(fan);
    EXPECT_THROW(make_sensor(multibeam(fan)), std::invalid_argument);
  };
  refused([](MultibeamDescription& f) { f.beams = 0; });
  refused([](MultibeamDescription& f) { f.samples = 0; });
  refused([](MultibeamDescription& f) { f.swath_deg = 180; });
  refused([](MultibeamDescription& f) { f.swath_deg = 179; });  // the outermost beams look up
  refused([](MultibeamDescription& f) { f.swath_deg = std::nan(""); });
  refused([](MultibeamDescription& f) { f.beam_across_deg = 0; });
  refused([](MultibeamDescription& f) { f.along_track_deg = 180; });
  refused([](MultibeamDescription& f) { f.range_min_m = -1; });
  refused([](MultibeamDescription& f) { f.range_max_m = f.range_min_m; });
}

// A beam of uniform solid angle on a Lambert plane whose nearest line lies `tilt` from straight down of the
// sensor: dE = R^-3 exp(-beta R) d(angle), R = H / cos(angle - tilt). The test integrates it by a fine
// midpoint rule.
TEST(BottomFinder, CentroidIsTheAxisRangeOnAPlaneOfAnySlope) {
  MultibeamDescription fan;
  fan.swath_deg = 120;
  fan.beams = 81;
  fan.samples = 1600;
  fan.range_min_m = 4;
  fan.range_max_m = 84;
  for (const double tilt : {0.0, -9.0, 14.0}) {
    samples::OwnedRecording made = samples::silent(multibeam(fan), 1);
    constexpr double height = 18;
    const double beta = 2 * made.recording.absorption_db_per_km / 1000 * std::log(10) / 10;
    for (std::size_t beam = 0; beam < 81; ++beam)
      for (int k = 0; k < 20000; ++k) {
        const double angle = (-60 + 1.5 * double(beam) + (k + 0.5) / 20000 * 1.5 - 0.75 - tilt) * degree;
        const double range = height / std::cos(angle);
        made.energy(0, beam, std::size_t((range - 4) / 0.05)) +=
            std::pow(range, -3) * std::exp(-beta * range);
      }
    const SoundedPing sounded = BottomFinder(made.recording, {}, {}).sound(0);
    for (std::size_t beam = 0; beam < 81; ++beam) {
      ASSERT_TRUE(sounded.soundings[beam]);
      const Sounding& sounding = *sounded.soundings[beam];
      const double axis = -60 + 1.5 * double(beam), range = height / std::cos((axis - tilt) * degree);
      EXPECT_NEAR(sounding.slant_range_m, range, 0.026 + range * 3e-5) << tilt << " " << beam;
      EXPECT_NEAR(sounding.beam_angle_deg, axis, 1e-9);
      EXPECT_NEAR(sounding.position_m.x, sounding.slant_range_m * std::sin(axis * degree), 1e-9);
      EXPECT_NEAR(sounding.position_m.z, -5 - sounding.slant_range_m * std::cos(axis * degree), 1e-9);
      EXPECT_NEAR(sounding.two_way_travel_time_s, 2 * sounding.slant_range_m / 1480, 1e-12);
    }
  }
}

// Noise of a hundredth of the echo in 1500 range bins, amplified with the square of the range.
TEST(BottomFinder, NoiseAloneIsNoBottomAndDoesNotPullAtOne) {
  SensorDescription description = multibeam();
  description.signal.noise_level_db = 100;  // 1e-11 J at 210 dB
  samples::OwnedRecording made = samples::silent(description, 8);
  for (std::size_t ping = 0; ping < 8; ++ping)
    for (std::size_t k = 400; k < 440; ++k) made.energy(ping, 30, k) = 1e-9;
  const BottomFinder finder(made.recording, {}, {});
  for (std::size_t ping = 0; ping < 8; ++ping) {
    const SoundedPing sounded = finder.sound(ping);
    for (std::size_t beam = 0; beam < 101; ++beam)
      ASSERT_EQ(sounded.soundings[beam].has_value(), beam == 30) << ping << " " << beam;
    EXPECT_NEAR(sounded.soundings[30]->slant_range_m,
                BottomFinder::ideal(made.recording, {}).sound(ping).soundings[30]->slant_range_m,
                made.recording.sensor->samples().step_m);
    EXPECT_TRUE(sounded.soundings[30]->flags.empty());
  }
}

TEST(BottomFinder, ASilentBeamHasNoSounding) {
  samples::OwnedRecording made = samples::silent(multibeam(), 1);
  made.energy(0, 3, 700) = 1e-9;
  const SoundedPing sounded = BottomFinder(made.recording, {}, {}).sound(0);
  ASSERT_EQ(sounded.soundings.size(), 101u);
  for (std::size_t beam = 0; beam < 101; ++beam)
    EXPECT_EQ(sounded.soundings[beam].has_value(), beam == 3) << beam;
  // 210 dB re 1 uPa for 1 J, 90 dB less.
  EXPECT_NEAR(20 * std::log10(sounded.soundings[3]->amplitude), 120, 1e-9);
}

}  // namespace
}  // namespace tubefoot
