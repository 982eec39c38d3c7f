// SPDX-License-Identifier: GPL-3.0-or-later
// Tests imaging sonars, echosounders and interferometric sidescans as sensors: their beams, tubes and
// receiver pairs.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "fixtures/world/recordings.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/kinds/kind_didson.hpp"
#include "sensors/kinds/kind_echosounder.hpp"
#include "sensors/kinds/kind_imaging.hpp"
#include "sensors/kinds/kind_interferometric.hpp"
#include "sensors/kinds/kind_sidescan.hpp"

namespace tubefoot {
namespace {

using samples::grid;

template <typename Kind>
std::unique_ptr<Sensor> sensor_of(const Kind& kind) {
  SensorDescription description;
  description.name = "s";
  description.kind = kind;
  return make_sensor(description);
}

TEST(Imaging, IsACameraOfTheSameSector) {
  ImagingDescription imaging;
  imaging.beams = 64;
  imaging.horizontal_deg = 130;
  imaging.vertical_deg = 20;
  imaging.samples = 200;
  imaging.range_min_m = 2;
  imaging.range_max_m = 12;
  DidsonDescription didson;
  didson.beams = 64;
  didson.horizontal_deg = 130;
  didson.vertical_deg = 20;
  didson.samples = 200;
  didson.window_start_m = 2;
  didson.window_length_m = 10;
  const auto sonar = sensor_of(imaging), camera = sensor_of(didson);
  EXPECT_TRUE(sonar->tubes(Pose{}, grid) == camera->tubes(Pose{}, grid));
  EXPECT_EQ(sonar->beam_of_tube(), camera->beam_of_tube());
  EXPECT_EQ(sonar->samples().first_m, 2);
  EXPECT_DOUBLE_EQ(sonar->samples().step_m, 0.05);
  ASSERT_EQ(sonar->beams().size(), 64u);
  EXPECT_NEAR(sonar->beams()[0].azimuth_rad / degree, -65 + 65.0 / 64, 1e-12);
  EXPECT_FALSE(sonar->has_patterns());
  EXPECT_EQ(sonar->channels(), 1);
}

TEST(Imaging, RefusesWhatIsNoSonar) {
  const auto refused = [](auto change) {
    ImagingDescription imaging;
    change(imaging);
    EXPECT_THROW(sensor_of(imaging), std::invalid_argument);
  };
  refused([](ImagingDescription& d) { d.beams = 0; });
  refused([](ImagingDescription& d) { d.samples = 0; });
  refused([](ImagingDescription& d) { d.horizontal_deg = 361; });
  refused([](ImagingDescription& d) { d.vertical_deg = 180; });
  refused([](ImagingDescription& d) { d.range_min_m = -1; });
  refused([](ImagingDescription& d) { d.range_max_m = d.range_min_m; });
}

TEST(Echosounder, LooksDownThroughASquareOfThreeBeamWidths) {
  EchosounderDescription sounder;
  sounder.beam_deg = 6;
  const auto sensor = sensor_of(sounder);
  const TubeSet set = sensor->tubes(Pose{}, grid);
  ASSERT_EQ(sensor->beam_of_tube().size(), set.tubes.size());
  double starboard = 0, forward = 0;
  for (const GridPoint& ray : set.rays) {
    EXPECT_LT(ray.z, 0);
    starboard = std::max(starboard, std::atan2(double(ray.x), -double(ray.z)) / degree);
    const double level = std::hypot(double(ray.x), double(ray.z));
    forward = std::max(forward, std::atan2(double(ray.y), level) / degree);
  }
  EXPECT_NEAR(starboard, 9, 1e-6);
  EXPECT_NEAR(forward, 9, 4.6e-5 * 9);  // corners lie inside of the cone by its tolerance
  const BeamPatterns patterns = sensor->patterns(Pose{}, 1500);
  const glm::dvec3 aside = glm::normalize(glm::dvec3(0, std::sin(3 * degree), -std::cos(3 * degree)));
  EXPECT_NEAR(patterns.transmit.at(0).gain(aside), 0.5, 1e-12);
  EXPECT_NEAR(patterns.receive.at(0).gain(aside), 0.5, 1e-12);
  EXPECT_NEAR(patterns.receive.at(0).gain({0, 0, -1}), 1, 1e-12);
}

TEST(Echosounder, RefusesWhatIsNoSounder) {
  const auto refused = [](auto change) {
    EchosounderDescription sounder;
    change(sounder);
    EXPECT_THROW(sensor_of(sounder), std::invalid_argument);
  };
  refused([](EchosounderDescription& d) { d.beam_deg = 0; });
  refused([](EchosounderDescription& d) { d.sector_deg = 171; });
  refused([](EchosounderDescription& d) { d.samples = 0; });
  refused([](EchosounderDescription& d) { d.range_min_m = -1; });
  refused([](EchosounderDescription& d) { d.range_max_m = d.range_min_m; });
}

TEST(Interferometric, ReceiverPairsStandAcrossWhatTheyFace) {
  InterferometricDescription swath;
  swath.frequency_khz = 250;
  swath.baseline_m = 0.02;
  swath.receiver_pair_tilt_deg = 25;
  const auto sensor = sensor_of(swath), sidescan = sensor_of(static_cast<const SidescanDescription&>(swath));
  EXPECT_EQ(sensor->channels(), 4);
  EXPECT_TRUE(sensor->tubes(Pose{}, grid).rays == sidescan->tubes(Pose{}, grid).rays);
  EXPECT_TRUE(sensor->tubes(Pose{}, grid).tubes == sidescan->tubes(Pose{}, grid).tubes);
  EXPECT_TRUE(sensor->has_patterns());
  Pose turned;
  turned.attitude = attitude_from_angles(90 * degree, 0, 0);  // starboard is south
  const BeamPatterns patterns = sensor->patterns(turned, 1500);
  ASSERT_EQ(patterns.baselines.size(), 2u);
  for (const int side : {-1, 1}) {
    const ReceiverBaseline& baseline = patterns.baselines[side < 0 ? 0 : 1];
    EXPECT_NEAR(baseline.axis.x, 0, 1e-12);
    EXPECT_NEAR(baseline.axis.y, -side * std::sin(25 * degree), 1e-12);
    EXPECT_NEAR(baseline.axis.z, std::cos(25 * degree), 1e-12);
    EXPECT_EQ(baseline.baseline_m, 0.02);
    EXPECT_NEAR(baseline.wavenumber_rad_m, 2 * std::numbers::pi / 0.006, 1e-9);
  }
  swath.baseline_m = 0;
  EXPECT_THROW(sensor_of(swath), std::invalid_argument);
  swath.baseline_m = swath.range_min_m + 0.01;
  EXPECT_THROW(sensor_of(swath), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
