// SPDX-License-Identifier: GPL-3.0-or-later
// Tests acoustic cameras: centres of lens beams by the published polynomial, and firing cycles that share
// out the beams.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "fixtures/world/recordings.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/kinds/kind_didson.hpp"
#include "sensors/model/lens_beams.hpp"
#include "sensors/model/sensor.hpp"

namespace tubefoot {
namespace {

using samples::grid;

std::unique_ptr<Sensor> camera(const std::function<void(SensorDescription&, DidsonDescription&)>& change,
                               int beams = 96) {
  SensorDescription description = samples::camera(beams);
  change(description, description.kind.edit<DidsonDescription>());
  return make_sensor(description);
}

std::vector<std::vector<GridPoint>> corners(const TubeSet& set) {
  std::vector<std::vector<GridPoint>> all;
  for (const Tube& tube : set.tubes) {
    all.emplace_back();
    for (const auto corner : tube) all.back().push_back(set.rays[corner]);
  }
  return all;
}

/// Range of azimuths of the tubes, horizontal at the camera.
std::pair<double, double> extent_deg(const TubeSet& set) {
  std::pair extent{1e9, -1e9};
  for (const GridPoint& ray : set.rays) {
    const double azimuth = std::atan2(double(ray.x), double(ray.y)) / degree;
    extent = {std::min(extent.first, azimuth), std::max(extent.second, azimuth)};
  }
  return extent;
}

TEST(LensBeams, CentresAreThoseOfThePublishedPolynomial) {
  // The tables of the formats sheet for k = 1, 24, 49, 50 and the last.
  const std::vector<double> high = lens_beam_centres(96);
  ASSERT_EQ(high.size(), 96u);
  EXPECT_NEAR(high[0] / degree, -14.252, 6e-4);
  EXPECT_NEAR(high[23] / degree, -8.578, 6e-4);
  EXPECT_NEAR(high[48] / degree, -0.227, 6e-4);
  EXPECT_NEAR(high[49] / degree, 0.141, 6e-4);
  EXPECT_NEAR(high[95] / degree, 14.259, 6e-4);
  const std::vector<double> low = lens_beam_centres(48);
  ASSERT_EQ(low.size(), 48u);
  EXPECT_NEAR(low[0] / degree, -14.250, 6e-4);
  EXPECT_NEAR(low[24] / degree, -0.073, 6e-4);
  EXPECT_NEAR(low[47] / degree, 14.374, 6e-4);
  EXPECT_THROW(lens_beam_centres(64), std::invalid_argument);
}

TEST(LensBeams, IdealBeamsMeetMidwayBetweenCentres) {
  const auto sensor = camera([](auto&, auto& didson) { didson.beam_centres = "lens"; });
  const std::vector<double> centres = lens_beam_centres(96);
  const TubeSet set = sensor->tubes(Pose{}, grid);
  ASSERT_EQ(set.tubes.size(), 96u);
  for (std::size_t beam = 0; beam < 96; ++beam) {
    EXPECT_DOUBLE_EQ(sensor->beams()[beam].azimuth_rad, centres[beam]);
    double left = 1e9, right = -1e9;
    for (const auto corner : set.tubes[beam]) {
      const double azimuth = std::atan2(double(set.rays[corner].x), double(set.rays[corner].y));
      left = std::min(left, azimuth);
      right = std::max(right, azimuth);
    }
    const double before = beam > 0 ? centres[beam - 1] : 2 * centres[0] - centres[1],
                 after = beam < 95 ? centres[beam + 1] : 2 * centres[95] - centres[94];
    EXPECT_NEAR(left, (before + centres[beam]) / 2, 1e-7);
    EXPECT_NEAR(right, (centres[beam] + after) / 2, 1e-7);
    EXPECT_NEAR(right - left, sensor->beams()[beam].azimuth_width_rad, 2e-7);
  }
}

TEST(DidsonCycles, ShareOutTheBeamsInTheOrderOfFiring) {
  const auto sensor = camera([](auto&, auto& didson) {
    didson.cycles = 4;
    didson.cycle_interval_s = 0.01;
    didson.firing_order = {3, 0, 2, 1};
  });
  ASSERT_EQ(sensor->transmissions(), 4u);
  for (std::size_t transmission = 0; transmission < 4; ++transmission) {
    EXPECT_DOUBLE_EQ(sensor->transmission_delay_s(transmission), 0.01 * double(transmission));
    const std::size_t cycle = std::array{3, 0, 2, 1}[transmission];
    ASSERT_EQ(sensor->beams_of_transmission(transmission).size(), 24u);
    for (std::size_t channel = 0; channel < 24; ++channel)
      EXPECT_EQ(sensor->beams_of_transmission(transmission)[channel], channel * 4 + cycle);
  }
}

TEST(DidsonCycles, FollowEachOtherWhenTheWindowsEndHasCome) {
  const auto sensor = camera([](auto&, auto& didson) { didson.cycles = 8; });
  ASSERT_EQ(sensor->transmissions(), 8u);
  EXPECT_DOUBLE_EQ(sensor->transmission_delay_s(0), 0);
  EXPECT_NEAR(sensor->transmission_delay_s(7), 7 * (2 * 5.84 / 1500 + 420e-6), 1e-12);
}

TEST(DidsonCycles, OfIdealBeamsLookWhereTheirBeamsLook) {
  for (const char* centres : {"even", "lens"}) {
    const auto at_once = camera([&](auto&, auto& didson) { didson.beam_centres = centres; });
    const auto in_turn = camera([&](auto&, auto& didson) {
      didson.beam_centres = centres;
      didson.cycles = 8;
    });
    const auto all = corners(at_once->tubes(Pose{}, grid));
    std::size_t tubes = 0;
    for (std::size_t transmission = 0; transmission < 8; ++transmission) {
      const auto own = corners(in_turn->tubes(Pose{}, grid, transmission));
      ASSERT_EQ(own.size(), in_turn->beam_of_tube(transmission).size());
      for (std::size_t tube = 0; tube < own.size(); ++tube)
        EXPECT_EQ(
            own[tube],
            all[in_turn->beams_of_transmission(transmission)[in_turn->beam_of_tube(transmission)[tube]]]);
      tubes += own.size();
    }
    EXPECT_EQ(tubes, 96u);
  }
}

TEST(DidsonCycles, WithPatternsEveryTransmissionLightsTheFanAndItsMarginsByTheSumOfItsBeams) {
  const auto sensor = camera([](auto& description, auto& didson) {
    didson.cycles = 8;
    didson.receive_margin_deg = 1.5;
    description.transmit.pattern = description.receive.pattern = "line";
    description.transmit.aperture_m = description.receive.aperture_m = 0.1;
  });
  for (std::size_t transmission = 0; transmission < 8; ++transmission) {
    const TubeSet set = sensor->tubes(Pose{}, grid, transmission);
    const auto [left, right] = extent_deg(set);
    EXPECT_NEAR(left, -16, 1e-5);
    EXPECT_NEAR(right, 16, 1e-5);
    const BeamPatterns patterns = sensor->patterns(Pose{}, 1500, transmission);
    ASSERT_EQ(patterns.transmit.size(), 1u);
    ASSERT_EQ(patterns.transmit[0].beams.size(), 12u);
    ASSERT_EQ(patterns.receive.size(), 12u);
    ASSERT_EQ(patterns.beams_of_tube.size(), set.tubes.size());
    for (const auto& received : patterns.beams_of_tube) EXPECT_EQ(received, std::pair(0u, 12u));
    for (std::size_t channel = 0; channel < 12; ++channel) {
      const double a = sensor->beams()[8 * channel + transmission].azimuth_rad;
      const glm::dvec3 axis{std::sin(a), std::cos(a), 0};
      EXPECT_NEAR(patterns.receive[channel].gain(axis), 1, 1e-12);
      EXPECT_NEAR(patterns.transmit[0].beams[channel].gain(axis), 1, 1e-12);
    }
  }
}

TEST(DidsonCycles, OneProjectorMayLightTheFan) {
  const auto set = [](SensorDescription& description, const char* angle) {
    description.transmit.pattern = "gaussian";
    description.transmit.width_deg = 30;
    description.transmit.angle = angle;
  };
  const auto requested = camera([&](auto& description, auto& didson) {
    didson.cycles = 8;
    didson.transmit_steering = "fan";
    set(description, "azimuth");
  });
  const auto elevation = camera([&](auto& description, auto& didson) {
    didson.cycles = 8;
    set(description, "elevation");
  });
  const auto at_once = camera([&](auto& description, auto&) { set(description, "azimuth"); });
  for (const Sensor* sensor : {requested.get(), elevation.get(), at_once.get()}) {
    const BeamPatterns patterns = sensor->patterns(Pose{}, 1500);
    ASSERT_EQ(patterns.transmit[0].beams.size(), 1u);
    EXPECT_NEAR(patterns.transmit[0].gain({0, 1, 0}), 1, 1e-12);
  }
}

TEST(Didson, MarginsBelongToTheOutermostBeams) {
  const auto sensor = camera([](auto& description, auto& didson) {
    didson.receive_margin_deg = 1;
    description.receive.pattern = "line";
    description.receive.aperture_m = 0.1;
  });
  const TubeSet set = sensor->tubes(Pose{}, grid);
  EXPECT_NEAR(extent_deg(set).first, -15.5, 1e-5);
  EXPECT_NEAR(extent_deg(set).second, 15.5, 1e-5);
  ASSERT_EQ(set.tubes.size(), 98u);
  EXPECT_EQ(sensor->beam_of_tube()[1], 0u);
  EXPECT_EQ(sensor->beam_of_tube()[97], 95u);
}

TEST(Didson, RefusesCyclesThatDoNotShareOutItsBeams) {
  using Change = std::function<void(SensorDescription&, DidsonDescription&)>;
  const std::pair<const char*, Change> bad[] = {
      {"cycles", [](auto&, auto& d) { d.cycles = 7; }},
      {"cycles", [](auto&, auto& d) { d.cycles = 0; }},
      {"firing_order",
       [](auto&, auto& d) {
         d.cycles = 2;
         d.firing_order = {1, 1};
       }},
      {"firing_order",
       [](auto&, auto& d) {
         d.firing_order = {0, 1};
       }},
      {"cycle_interval_s", [](auto&, auto& d) { d.cycle_interval_s = -1; }},
      {"receive_margin_deg", [](auto&, auto& d) { d.receive_margin_deg = -1; }},
      {"transmit_steering",
       [](auto& s, auto& d) {
         s.transmit.angle = "elevation";
         d.transmit_steering = "beams";
       }},
  };
  for (const auto& [key, change] : bad) {
    try {
      camera(change);
      ADD_FAILURE() << "no error for " << key;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(key));
    }
  }
  EXPECT_THROW(camera([](auto&, auto& d) { d.beam_centres = "lens"; }, 64), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
