// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the choice among the possible angles of a phase. The recordings come from the closed form of a
// seabed.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "fixtures/world/recordings.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/detection/receiver_pair_soundings.hpp"
#include "sensors/kinds/kind_interferometric.hpp"
#include "sensors/receiver/phase_noise.hpp"

namespace tubefoot {
namespace {

constexpr double depth_m = 12, baseline_m = 0.012, wavelength_m = 0.003;
constexpr double tilt_rad = 30 * degree;

struct FlatSeabed {
  std::unique_ptr<Sensor> sensor;
  Recording recording;
  std::vector<double> values;

  /// Echoes from `nearest_m` on, of a seabed that is level in the frame of the sensor.
  explicit FlatSeabed(double nearest_m, double altitude_m, double coherence = 1,
                      glm::dquat attitude = {1, 0, 0, 0}, double receiver_pair_m = baseline_m) {
    InterferometricDescription swath;
    swath.frequency_khz = 500;
    swath.baseline_m = receiver_pair_m;
    swath.receiver_pair_tilt_deg = 30;
    swath.samples = 1000;
    swath.range_min_m = 10;
    swath.range_max_m = 40;
    SensorDescription description;
    description.name = "swath";
    description.kind = swath;
    sensor = make_sensor(description);
    recording.sensor = sensor.get();
    recording.ping_time_s = {0};
    recording.ping_pose = {{{5, 7, -1}, attitude}};
    recording.altitude_m = {altitude_m};
    recording.sound_speed_m_s = 1500;
    values.assign(4 * 2 * 1000, 0.0);
    for (std::size_t cell = 0; cell < 2000; ++cell) {
      const double range = 10 + (double(cell % 1000) + 0.5) * 0.03;
      if (range < std::max(nearest_m, depth_m)) continue;
      const double phase = 2 * std::numbers::pi * receiver_pair_m / wavelength_m *
                           std::sin(std::asin(depth_m / range) - tilt_rad);
      values[cell] = values[2000 + cell] = 2;
      values[4000 + cell] = 2 * coherence * std::cos(phase);
      values[6000 + cell] = 2 * coherence * std::sin(phase);
    }
    recording.energy = values;
  }
};

TEST(InterferometricSoundings, FollowTheSeabedFromItsNearestEchoOrFromTheAltitude) {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [nearest_m, altitude_m] : {std::pair(0.0, unknown), {0.0, 12.5}, {20.0, 11.5}}) {
    const FlatSeabed seabed(nearest_m, altitude_m);
    const auto found = interferometric_soundings(seabed.recording, 0, {});
    EXPECT_GT(found.size(), 1300u);
    for (const InterferometricSounding& s : found) {
      ASSERT_NEAR(s.estimate.depth_m, depth_m, 1e-9) << nearest_m << " " << s.range_m;
      EXPECT_NEAR(s.coherence, 1, 1e-12);
      EXPECT_EQ(s.energy_j, 2);
      EXPECT_LT(s.estimate.depth_sigma_m, 1e-4);
      const double across = std::sqrt(s.range_m * s.range_m - depth_m * depth_m);
      EXPECT_NEAR(s.position_m.x, 5 + (s.beam == 0 ? -across : across), 1e-8);
      EXPECT_NEAR(s.position_m.y, 7, 1e-12);
      EXPECT_NEAR(s.position_m.z, -13, 1e-9);
    }
  }
  // An estimate that takes the nearest echo as the depth misses a distant seabed, so that the altitude is
  // needed.
  const FlatSeabed far(20, unknown);
  const auto lost = interferometric_soundings(far.recording, 0, {});
  ASSERT_FALSE(lost.empty());
  EXPECT_GT(std::abs(lost.front().estimate.depth_m - depth_m), 1);
}

TEST(InterferometricSoundings, LeanWithTheSensor) {
  const double roll = 10 * degree;
  const FlatSeabed seabed(0, 12, 1, attitude_from_angles(0, 0, roll));  // starboard down
  for (const InterferometricSounding& s : interferometric_soundings(seabed.recording, 0, {})) {
    const double across = (s.beam == 0 ? -1 : 1) * s.estimate.horizontal_m;
    ASSERT_NEAR(s.position_m.x, 5 + across * std::cos(roll) - depth_m * std::sin(roll), 1e-8);
    ASSERT_NEAR(s.position_m.z, -1 - across * std::sin(roll) - depth_m * std::cos(roll), 1e-8);
  }
}

TEST(InterferometricSoundings, NoiseOfTheReceiversLowersCoherenceAndWidensSigma) {
  const FlatSeabed seabed(0, 12, 0.9);
  const auto clear = interferometric_soundings(seabed.recording, 0, {}),
             noisy = interferometric_soundings(seabed.recording, 0, {1.0});
  ASSERT_EQ(clear.size(), noisy.size());
  for (std::size_t k = 0; k < clear.size(); ++k) {
    EXPECT_NEAR(clear[k].coherence, 0.9, 1e-12);
    EXPECT_NEAR(noisy[k].coherence, 0.6, 1e-12);  // 1.8 / (2 + 1)
    EXPECT_EQ(noisy[k].phase_rad, clear[k].phase_rad);
    EXPECT_GT(noisy[k].estimate.angle_sigma_rad, 1.3 * clear[k].estimate.angle_sigma_rad);
    EXPECT_NEAR(clear[k].estimate.angle_sigma_rad,
                std::sqrt(0.478341) * wavelength_m /
                    (2 * std::numbers::pi * baseline_m * std::cos(clear[k].estimate.angle_rad - tilt_rad)),
                1e-5 * clear[k].estimate.angle_sigma_rad);
  }
}

// Each line has its phase. The errors of all lines have the variance of the law, at any coherence.
TEST(InterferometricSoundings, NoisyPhasesLoseNoLineAndHaveTheLawsVariance) {
  for (const double coherence : {0.1, 0.3, 0.6, 0.9, 0.99})
    for (const double baseline : {baseline_m, wavelength_m / 2}) {
      FlatSeabed seabed(0, 12, coherence, {1, 0, 0, 0}, baseline);
      const auto clear = interferometric_soundings(seabed.recording, 0, {});
      double sum = 0, fourth = 0, count = 0;
      for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const auto noisy = interferometric_soundings(seabed.recording, 0, {0, true, seed});
        ASSERT_EQ(noisy.size(), clear.size()) << "seed " << seed << ", coherence " << coherence;
        for (std::size_t k = 0; k < noisy.size(); ++k) {
          const double error = std::remainder(noisy[k].phase_rad - clear[k].phase_rad, 2 * std::numbers::pi);
          sum += error * error;
          fourth += std::pow(error, 4);
          ++count;
        }
      }
      const double variance = sum / count, sigma = std::sqrt((fourth / count - variance * variance) / count);
      EXPECT_NEAR(variance, phase_variance(coherence), 4 * sigma) << coherence << ", seeds 1 to 20";
      EXPECT_GT(count, 25000);
    }
}

}  // namespace
}  // namespace tubefoot
