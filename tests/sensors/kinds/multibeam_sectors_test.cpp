// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the transmit sectors of multibeams: their beams, tubes, tilted cones, patterns and receivers, and the
// errors of their keys.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "fixtures/world/read_scenes.hpp"
#include "fixtures/world/recordings.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/kinds/kind_multibeam.hpp"
#include "sensors/products/swath_soundings.hpp"

namespace tubefoot {
namespace {

using samples::grid;
using samples::unit;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

SensorDescription sectored(const MultibeamDescription& fan) {
  SensorDescription description;
  description.name = "multibeam";
  description.kind = fan;
  return description;
}

MultibeamDescription three_sectors() {
  MultibeamDescription fan;
  fan.sector_edges_deg = {-75, -20, 22.5, 75};
  return fan;
}

TEST(MultibeamSectors, OneSectorWithTheValuesOfTheSensorIsNone) {
  MultibeamDescription fan;
  fan.sector_edges_deg = {-75, 75};
  fan.sector_frequencies_khz = {240};
  fan.sector_tilts_deg = fan.sector_delays_us = {0};
  const auto explicit_one = make_sensor(sectored(fan)), without = make_sensor(sectored({}));
  EXPECT_TRUE(explicit_one->transmit_sectors().empty());
  EXPECT_EQ(explicit_one->transmissions(), 1u);
  EXPECT_EQ(explicit_one->tubes(Pose{}, grid), without->tubes(Pose{}, grid));
  for (std::size_t beam = 0; beam < 101; ++beam) {
    EXPECT_EQ(explicit_one->beams()[beam].azimuth_rad, without->beams()[beam].azimuth_rad);
    EXPECT_EQ(explicit_one->beams()[beam].elevation_rad, without->beams()[beam].elevation_rad);
  }
}

// Half-open intervals: the beam at 22.5 degrees belongs to the sector that begins there.
TEST(MultibeamSectors, EachBeamBelongsToTheSectorOfItsAxis) {
  const auto sensor = make_sensor(sectored(three_sectors()));
  ASSERT_EQ(sensor->transmissions(), 3u);
  std::size_t beam = 0;
  for (std::size_t t = 0; t < 3; ++t)
    for (const std::uint32_t own : sensor->beams_of_transmission(t)) {
      EXPECT_EQ(own, beam);
      EXPECT_EQ(sensor->beams()[own].sector, t);
      const double angle_deg = -75 + 1.5 * double(beam++);
      EXPECT_EQ(t, angle_deg < -20 ? 0u : angle_deg < 22.5 ? 1u : 2u) << angle_deg;
    }
  EXPECT_EQ(beam, 101u);
}

TEST(MultibeamSectors, WithoutTiltTheirTubesAreThoseOfOneSector) {
  for (const char* spacing : {"angle", "distance"}) {
    MultibeamDescription fan = three_sectors(), one;
    fan.spacing = one.spacing = spacing;
    const auto sensor = make_sensor(sectored(fan)), without = make_sensor(sectored(one));
    const TubeSet whole = without->tubes(Pose{}, grid);
    std::size_t tube = 0;
    for (std::size_t t = 0; t < 3; ++t) {
      const TubeSet part = sensor->tubes(Pose{}, grid, t);
      for (const auto& corners : part.tubes) {
        for (std::size_t k = 0; k < corners.size(); ++k)
          EXPECT_EQ(part.rays[corners[k]], whole.rays[whole.tubes.at(tube)[k]]);
        ++tube;
      }
    }
    EXPECT_EQ(tube, whole.tubes.size());
  }
}

// A tilted sector is bounded by the cones of tilt plus and minus half of the along-track width about the
// forward axis.
TEST(MultibeamSectors, TiltIsAConeAboutTheForwardAxis) {
  MultibeamDescription fan = three_sectors();
  fan.sector_tilts_deg = {-8, 0, 5};
  const auto sensor = make_sensor(sectored(fan));
  for (std::size_t beam = 0; beam < 101; ++beam) {
    const BeamAxis& axis = sensor->beams()[beam];
    const double tilt = fan.sector_tilts_deg[axis.sector] * degree,
                 across = (-75 + 1.5 * double(beam)) * degree;
    const glm::dvec3 direction = beam_direction(axis);
    EXPECT_NEAR(glm::length(direction), 1, 1e-14);
    EXPECT_NEAR(direction.y, std::sin(tilt), 1e-14);
    EXPECT_NEAR(direction.x, std::cos(tilt) * std::sin(across), 1e-14);
    EXPECT_NEAR(across_angle_rad(axis), across, 1e-14);
  }
  for (std::size_t t = 0; t < 3; ++t) {
    const TubeSet set = sensor->tubes(Pose{}, grid, t);
    for (std::size_t tube = 0; tube < set.tubes.size(); ++tube) {
      const double axis =
          across_angle_rad(sensor->beams()[sensor->beams_of_transmission(t)[sensor->beam_of_tube(t)[tube]]]);
      for (const auto corner : set.tubes[tube]) {
        const glm::dvec3 ray = unit(set.rays[corner]);
        EXPECT_NEAR(std::abs(std::asin(ray.y) / degree - fan.sector_tilts_deg[t]), 0.75, 5e-4);
        EXPECT_NEAR(std::abs(std::atan2(ray.x, -ray.z) - axis) / degree, 0.75, 1e-6);
      }
    }
  }
}

TEST(MultibeamSectors, PatternsUseTheFrequencyAndTheTiltOfTheSector) {
  MultibeamDescription fan = three_sectors();
  fan.sector_frequencies_khz = {200, 300, 400};
  fan.sector_tilts_deg = {4, 0, -4};
  SensorDescription description = sectored(fan);
  description.transmit.pattern = "line";
  description.transmit.aperture_m = 0.25;
  const auto sensor = make_sensor(description);
  for (std::size_t t = 0; t < 3; ++t) {
    EXPECT_EQ(sensor->frequency_khz(t), fan.sector_frequencies_khz[t]);
    const double length = 0.25 * fan.sector_frequencies_khz[t] * 1e3 / 1500;  // wavelengths
    const BeamPatterns patterns = sensor->patterns(Pose{}, 1500, t);
    for (const double along_deg : {-4.0, 0.0, 1.0, 4.0}) {
      const double u = length * (std::sin(along_deg * degree) - std::sin(fan.sector_tilts_deg[t] * degree));
      const double sinc = u == 0 ? 1 : std::sin(std::numbers::pi * u) / (std::numbers::pi * u);
      EXPECT_NEAR(
          patterns.transmit.at(0).gain({0, std::sin(along_deg * degree), -std::cos(along_deg * degree)}),
          sinc * sinc, 1e-12);
    }
  }
  EXPECT_EQ(sensor->frequency_khz(), 240);
}

/// A recording of one ping with an energy of 1e-9 J/m2 in range bin 1000 of each beam.
samples::OwnedRecording one_echo(const SensorDescription& description) {
  samples::OwnedRecording made = samples::silent(description, 1);
  for (std::size_t beam = 0; beam < made.sensor->beams().size(); ++beam) made.energy(0, beam, 1000) = 1e-9;
  made.recording.energy = made.energies;
  for (std::size_t t = 0; t < made.sensor->transmit_sectors().size(); ++t)
    made.recording.sector_absorption_db_per_km.push_back(50 * double(t + 1));
  return made;
}

// Half of c tau is 40, 80 and 160 bins. An echo is spread over as many bins, and its level increases with the
// length. It begins in the middle of bin 1000.
TEST(MultibeamSectors, ReceiverUsesPulseAndAbsorptionOfTheSector) {
  MultibeamDescription fan = three_sectors();
  const double bin_us = 2 * 99.5 / 2000 / 1480 * 1e6;
  fan.sector_pulse_lengths_us = {40 * bin_us, 80 * bin_us, 160 * bin_us};
  SensorDescription description = sectored(fan);
  description.signal.tvg_spreading = 20;
  const samples::OwnedRecording made = one_echo(description);
  const ReceivedPings received(made.recording, {});
  const std::vector<double> energies = received.of(0);
  const double range_m = 0.5 + 1010.5 * 99.5 / 2000;
  for (const std::size_t beam : {0u, 50u, 100u}) {
    const std::size_t t = made.recording.sector_of(beam);
    const double bins = 40 * std::pow(2, double(t));
    EXPECT_NEAR(received.chain(beam).level_db(1), 210 + 10 * std::log10(bins), 1e-9);
    const double gain_db = 20 * std::log10(range_m) + 2 * 50 * double(t + 1) * range_m / 1000;
    EXPECT_NEAR(energies[beam * 2000 + 1010] / (1e-9 / bins * std::pow(10, gain_db / 10)), 1, 1e-9) << beam;
    const PingEnergies kept = made.recording.energy_of(0);
    EXPECT_EQ(received.of_beam(0, beam, kept).size(), 1000 + std::size_t(bins) + 1);
  }
}

TEST(MultibeamSectors, BeamPoseIsThatOfTheTransmission) {
  samples::OwnedRecording made = samples::silent(sectored(three_sectors()), 2);
  EXPECT_EQ(made.recording.beam_pose(1, 100).position_m, made.recording.ping_pose[1].position_m);
  for (int k = 0; k < 6; ++k) made.recording.transmission_pose.push_back(Pose{{k, 0, 0}, {1, 0, 0, 0}});
  EXPECT_EQ(made.recording.beam_pose(0, 0).position_m.x, 0);
  EXPECT_EQ(made.recording.beam_pose(0, 50).position_m.x, 1);
  EXPECT_EQ(made.recording.beam_pose(1, 0).position_m.x, 3);
  EXPECT_EQ(made.recording.beam_pose(1, 100).position_m.x, 5);
}

std::string sector_error(const std::string& lines) {
  return scene_error(TestFolder(), std::string(smallest_scene) +
                                       "[[sensors]]\nname = \"hull\"\nkind = \"multibeam\"\n" + lines);
}

TEST(MultibeamSectors, ErrorsNameTheKeyAndTheReason) {
  EXPECT_EQ(sector_error("sector_edges_deg = [-75, -20, 20, 75]\nsector_tilts_deg = [1, 0, 1]\n"), "");
  EXPECT_EQ(sector_error("sector_tilts_deg = [1]\nsector_delays_us = [5]\n"), "");
  EXPECT_THAT(
      sector_error("sector_edges_deg = [-75, 20, -20, 75]\n"),
      AllOf(HasSubstr("scene.toml:15:"), HasSubstr("the sectors overlap"), HasSubstr("-20 follows 20")));
  EXPECT_THAT(sector_error("sector_edges_deg = [-75, 0, 70]\n"),
              HasSubstr("the sectors leave a gap: beam 97 at 70.5 degrees is in no sector"));
  EXPECT_THAT(sector_error("sector_edges_deg = [-60, 0, 75]\n"), HasSubstr("beam 0 at -75 degrees"));
  EXPECT_THAT(sector_error("sector_edges_deg = [-75, 0.1, 0.2, 75]\n"),
              HasSubstr("sector 1 from 0.1 to 0.2 degrees has no beam"));
  EXPECT_THAT(sector_error("sector_edges_deg = [-75]\n"), HasSubstr("has one edge"));
  EXPECT_THAT(sector_error("sector_edges_deg = []\n"), HasSubstr("not an empty array"));
  for (const char* key : {"sector_frequencies_khz", "sector_tilts_deg", "sector_delays_us",
                          "sector_pulse_lengths_us", "sector_absorptions_db_per_km"}) {
    EXPECT_THAT(sector_error(std::string("sector_edges_deg = [-75, -20, 20, 75]\n") + key + " = [1, 1]\n"),
                AllOf(HasSubstr("scene.toml:16:"), HasSubstr(key),
                      HasSubstr("has 2 values, but the sonar has 3 sectors: give one value per sector")));
    EXPECT_THAT(sector_error(std::string(key) + " = [1, 1]\n"),
                HasSubstr("has 2 values, but the sonar has 1 sector: set 'sector_edges_deg'"));
  }
  EXPECT_THAT(sector_error("pings = 2\nping_interval_s = 0.001\nsector_delays_us = [1000]\n"),
              HasSubstr("a delay of 1000 us is longer than the ping"));
  EXPECT_EQ(sector_error("ping_interval_s = 0.001\nsector_delays_us = [1000]\n"), "");
  EXPECT_THAT(sector_error("along_track_deg = 10\nsector_tilts_deg = [-85]\n"),
              HasSubstr("a sector with a tilt of -85 degrees"));
  EXPECT_THAT(sector_error("sector_delays_us = [-1]\n"), HasSubstr("sector_delays_us"));
}

TEST(MultibeamSectors, InvalidDescriptionsThrow) {
  MultibeamDescription fan = three_sectors();
  fan.sector_tilts_deg = {1};
  EXPECT_THROW(make_sensor(sectored(fan)), std::invalid_argument);
  fan = three_sectors();
  fan.sector_edges_deg.back() = 60;
  EXPECT_THROW(make_sensor(sectored(fan)), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
