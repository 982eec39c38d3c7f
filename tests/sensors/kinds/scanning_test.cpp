// SPDX-License-Identifier: GPL-3.0-or-later
// Tests scanning sonars and imaging beams: steps and times of the head, patterns that rotate with it, and
// beams at listed angles.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <tuple>

#include "fixtures/world/recordings.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/kinds/kind_imaging.hpp"
#include "sensors/kinds/kind_scanning.hpp"

namespace tubefoot {
namespace {

using samples::grid;
using samples::unit;

template <class Keys>
SensorDescription described(const Keys& keys) {
  SensorDescription description;
  description.name = "s";
  description.kind = keys;
  return description;
}
double azimuth_deg(glm::dvec3 v) { return std::atan2(v.x, v.y) / degree; }

TEST(Scanning, TurnsOnceRoundClockwiseATransmissionAStep) {
  const auto sensor = make_sensor(described(ScanningDescription()));
  ASSERT_EQ(sensor->transmissions(), 400u);
  ASSERT_EQ(sensor->beams().size(), 400u);
  for (const std::size_t step : {0u, 1u, 199u, 399u}) {
    EXPECT_NEAR(sensor->beams()[step].azimuth_rad / degree, -180 + 0.9 * double(step), 1e-9);
    EXPECT_NEAR(sensor->transmission_delay_s(step), double(step) * (100.0 / 1500 + 0.02), 1e-9);
    EXPECT_EQ(sensor->beams_of_transmission(step), std::vector<std::uint32_t>{std::uint32_t(step)});
    for (const GridPoint ray : sensor->tubes(Pose{}, grid, step).rays) {
      const double off = std::abs(azimuth_deg(unit(ray)) - sensor->beams()[step].azimuth_rad / degree);
      EXPECT_LT(std::min(off, 360 - off), 1 + 1e-6);
      EXPECT_NEAR(std::abs(std::asin(unit(ray).z)) / degree, 12.5, 12.5 * 4.6e-5);
    }
  }
  EXPECT_FALSE(sensor->has_patterns());
}

// A stepper motor counts whole steps: a Ping360 looks at whole gradians, one of which is straight ahead.
TEST(Scanning, LooksAtWholeMultiplesOfItsStep) {
  for (const auto& [scan_deg, step_deg, first] : {std::tuple(360.0, 0.9, -200),
                                                  {90.0, 0.9, -50},
                                                  {81.9, 0.9, -45},
                                                  {360.0, 120.0, -1},
                                                  {1.8, 0.9, -1},
                                                  {0.9, 0.9, 0},
                                                  {100.0, 0.25, -200}}) {
    ScanningDescription scan;
    scan.scan_deg = scan_deg;
    scan.step_deg = step_deg;
    const auto sensor = make_sensor(described(scan));
    ASSERT_EQ(sensor->beams().size(), std::size_t(std::lround(scan_deg / step_deg)));
    bool ahead = false;
    for (std::size_t step = 0; step < sensor->beams().size(); ++step) {
      const double azimuth = sensor->beams()[step].azimuth_rad / degree;
      EXPECT_NEAR(azimuth / step_deg, first + double(step), 1e-9) << scan_deg << ' ' << step_deg;
      ahead = ahead || azimuth == 0;
    }
    EXPECT_TRUE(ahead) << scan_deg << ' ' << step_deg;
  }
}

// The data sheet of a Ping360: 9 s for a scan of 2 m, 35 s for one of 50 m.
TEST(Scanning, TakesAsLongAsAPing360) {
  ScanningDescription scan;
  EXPECT_NEAR(make_sensor(described(scan))->transmission_delay_s(399), 35, 0.6);
  scan.range_max_m = 2;
  EXPECT_NEAR(make_sensor(described(scan))->transmission_delay_s(399), 9, 0.2);
}

TEST(Scanning, ItsPatternsTurnWithTheHead) {
  ScanningDescription scan;
  scan.scan_deg = 270;
  scan.step_deg = 90;
  scan.beam_horizontal_deg = 40;
  SensorDescription description = described(scan);
  description.transmit.pattern = description.receive.pattern = "gaussian";
  description.transmit.width_deg = 6;
  description.receive.width_deg = 20;
  description.receive.angle = "elevation";
  const auto sensor = make_sensor(description);
  ASSERT_EQ(sensor->transmissions(), 3u);
  for (std::size_t step = 0; step < 3; ++step) {
    const double head = sensor->beams()[step].azimuth_rad;
    const BeamPatterns patterns = sensor->patterns(Pose{}, 1500, step);
    const auto towards = [&](double aside_deg, double up_deg) {
      const double a = head + aside_deg * degree, e = up_deg * degree;
      return glm::dvec3(std::cos(e) * std::sin(a), std::cos(e) * std::cos(a), std::sin(e));
    };
    EXPECT_NEAR(patterns.transmit.at(0).gain(towards(0, 0)), 1, 1e-12);
    EXPECT_NEAR(patterns.transmit.at(0).gain(towards(3, 0)), 0.5, 1e-12);
    EXPECT_NEAR(patterns.transmit.at(0).gain(towards(-3, 0)), 0.5, 1e-12);
    EXPECT_NEAR(patterns.receive.at(0).gain(towards(17, 10)), 0.5, 1e-12);
  }
}

TEST(Scanning, RefusesWhatMakesNoSonar) {
  const auto refused = [](auto change) {
    ScanningDescription scan;
    change(scan);
    EXPECT_THROW(make_sensor(described(scan)), std::invalid_argument);
  };
  refused([](ScanningDescription& s) { s.scan_deg = 361; });
  refused([](ScanningDescription& s) { s.step_deg = 0.7; });
  refused([](ScanningDescription& s) { s.step_deg = 0.01; });
  refused([](ScanningDescription& s) { s.beam_horizontal_deg = 0; });
  refused([](ScanningDescription& s) { s.beam_vertical_deg = 180; });
  refused([](ScanningDescription& s) { s.step_interval_s = -1; });
  refused([](ScanningDescription& s) { s.range_max_m = s.range_min_m; });
}

TEST(ImagingBeams, OfEqualDistanceMeetAWallAheadAtEvenSteps) {
  ImagingDescription fan;
  fan.beams = 8;
  fan.horizontal_deg = 120;
  fan.spacing = "distance";
  const auto sensor = make_sensor(described(fan));
  ASSERT_EQ(sensor->beams().size(), 8u);
  for (std::size_t beam = 0; beam < 8; ++beam)
    EXPECT_NEAR(std::tan(sensor->beams()[beam].azimuth_rad), std::sqrt(3) * (2 * double(beam) - 7) / 8,
                1e-12);
}

TEST(ImagingBeams, EndMidwayBetweenTheListedAxes) {
  ImagingDescription fan;
  fan.beam_angles_deg = {-20, -5, 1, 31};
  const auto sensor = make_sensor(described(fan));
  const double borders[] = {-27.5, -12.5, -2, 16, 46};
  const TubeSet set = sensor->tubes(Pose{}, grid);
  ASSERT_EQ(sensor->beam_of_tube().size(), set.tubes.size());
  std::vector<double> first(4, 999), last(4, -999);
  for (std::size_t tube = 0; tube < set.tubes.size(); ++tube)
    for (const auto corner : set.tubes[tube]) {
      const std::uint32_t beam = sensor->beam_of_tube()[tube];
      first[beam] = std::min(first[beam], azimuth_deg(unit(set.rays[corner])));
      last[beam] = std::max(last[beam], azimuth_deg(unit(set.rays[corner])));
    }
  for (std::size_t beam = 0; beam < 4; ++beam) {
    EXPECT_NEAR(sensor->beams()[beam].azimuth_rad / degree, fan.beam_angles_deg[beam], 1e-12);
    EXPECT_NEAR(sensor->beams()[beam].azimuth_width_rad / degree, borders[beam + 1] - borders[beam], 1e-12);
    EXPECT_NEAR(first[beam], borders[beam], 1e-6);
    EXPECT_NEAR(last[beam], borders[beam + 1], 1e-6);
  }
  const auto refused = [](std::vector<double> angles_deg) {
    ImagingDescription keys;
    keys.beam_angles_deg = std::move(angles_deg);
    EXPECT_THROW(make_sensor(described(keys)), std::invalid_argument);
  };
  refused({3});
  refused({1, 1});
  refused({-179, 0, 179});  // the outermost of these beams would overlap
}

TEST(ImagingBeams, OfAVerticalReceivePatternKeepTheirTubes) {
  SensorDescription description = described(ImagingDescription());
  description.receive.pattern = "gaussian";
  description.receive.width_deg = 20;
  for (const char* angle : {"azimuth", "elevation", "off_axis"}) {
    description.receive.angle = angle;
    const auto sensor = make_sensor(description);
    const BeamPatterns patterns = sensor->patterns(Pose{}, 1500);
    const bool own = std::string(angle) == "elevation";
    for (std::size_t tube = 0; tube < sensor->beam_of_tube().size(); ++tube) {
      const std::uint32_t beam = sensor->beam_of_tube()[tube];
      EXPECT_EQ(patterns.beams_of_tube[tube], own ? std::pair(beam, beam + 1) : std::pair(0u, 256u)) << angle;
    }
  }
}

}  // namespace
}  // namespace tubefoot
