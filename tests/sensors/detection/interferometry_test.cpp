// SPDX-License-Identifier: GPL-3.0-or-later
// Tests interferometry: phase and coherence of range bins, angles from phases, and their noise. The
// comparisons are closed forms.

#include "sensors/detection/interferometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fixtures/statistics.hpp"
#include "geometry/numbers/scalars.hpp"
#include "sensors/receiver/phase_noise.hpp"

namespace tubefoot {
namespace {

constexpr double wavelength = 0.006;  // 250 kHz at 1500 m/s

TEST(InterferometricSample, OnePathHasItsPhaseAndFullCoherence) {
  InterferometricSample sample;
  sample.add(3e-12, 0.25 * wavelength + 7 * wavelength, wavelength);
  EXPECT_NEAR(*sample.phase_rad(), pi / 2, 1e-12);
  EXPECT_NEAR(sample.coherence(), 1, 1e-15);
  EXPECT_EQ(sample.upper_j, 3e-12);
  EXPECT_EQ(sample.lower_j, 3e-12);
}

TEST(InterferometricSample, TwoEqualPathsLoseCoherenceAsACosine) {
  for (const double half : {0.0, 0.1, 0.7, 1.4}) {  // half of their phase difference
    InterferometricSample sample;
    sample.add(1e-9, (0.3 + half) / (2 * pi) * wavelength, wavelength);
    sample.add(1e-9, (0.3 - half) / (2 * pi) * wavelength, wavelength);
    EXPECT_NEAR(*sample.phase_rad(), 0.3, 1e-12);
    EXPECT_NEAR(sample.coherence(), std::cos(half), 1e-12);
  }
}

TEST(InterferometricSample, AnEvenFootprintDecorrelatesAsASinc) {
  const double extent = 1.8;  // of its phase
  InterferometricSample sample;
  const int paths = 4000;
  for (int i = 0; i < paths; ++i)
    sample.add(1e-9, extent * ((i + 0.5) / paths - 0.5) / (2 * pi) * wavelength, wavelength);
  EXPECT_NEAR(sample.coherence(), std::sin(extent / 2) / (extent / 2), 1e-6);
  EXPECT_NEAR(*sample.phase_rad(), 0, 1e-9);
}

TEST(InterferometricSample, NoiseTakesCoherenceBySignalToNoise) {
  for (const double ratio : {0.1, 1.0, 10.0}) {
    InterferometricSample sample;
    sample.add(ratio * 1e-10, 0.1 * wavelength, wavelength);
    sample.add_noise(1e-10, 1e-10);
    EXPECT_NEAR(sample.coherence(), ratio / (1 + ratio), 1e-12);
    EXPECT_NEAR(*sample.phase_rad(), 0.2 * pi, 1e-12);
  }
  InterferometricSample uneven;
  uneven.add(1, 0, wavelength);
  uneven.add_noise(3, 0);
  EXPECT_NEAR(uneven.coherence(), 0.5, 1e-15);
}

TEST(InterferometricSample, NothingHasNoPhase) {
  InterferometricSample sample;
  EXPECT_FALSE(sample.phase_rad());
  EXPECT_EQ(sample.coherence(), 0);
  sample.add_noise(1, 1);
  EXPECT_FALSE(sample.phase_rad());
  EXPECT_EQ(sample.coherence(), 0);
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  EXPECT_THROW(sample.add(-1, 0, wavelength), std::invalid_argument);
  EXPECT_THROW(sample.add(nan, 0, wavelength), std::invalid_argument);
  EXPECT_THROW(sample.add(1, inf, wavelength), std::invalid_argument);
  EXPECT_THROW(sample.add(1, 0, 0), std::invalid_argument);
  EXPECT_THROW(sample.add_noise(nan, 0), std::invalid_argument);
  EXPECT_THROW(sample.add_noise(0, -1), std::invalid_argument);
}

TEST(InterferometricSample, HalfATurnIsPlusPi) {
  EXPECT_EQ(wrapped(-pi), pi);
  EXPECT_EQ(wrapped(pi), pi);
  EXPECT_NEAR(wrapped(7), 7 - 2 * pi, 1e-15);
  EXPECT_NEAR(wrapped(-4), -4 + 2 * pi, 1e-15);
  InterferometricSample sample;
  sample.cross_j = {-1, -0.0};
  EXPECT_EQ(*sample.phase_rad(), pi);
}

TEST(Interferometer, HalfAWavelengthIsUnambiguous) {
  const double tilt = 30 * degree;
  const Interferometer receiver_pair(wavelength / 2, wavelength, tilt);
  for (double off = -89; off <= 89; off += 1) {
    const double angle = tilt + off * degree;
    EXPECT_NEAR(receiver_pair.phase(angle), pi * std::sin(off * degree), 1e-12);
    const auto angles = receiver_pair.angles(receiver_pair.phase(angle));
    ASSERT_EQ(angles.size(), 1) << off;
    EXPECT_NEAR(angles[0], angle, 1e-11);
  }
  EXPECT_EQ(receiver_pair.angles(pi).size(), 2);  // straight up and down the receiver pair
}

TEST(Interferometer, LongBaselinesHaveAllAnglesOfAPhase) {
  const double tilt = 20 * degree, ratio = 3.2;
  const Interferometer receiver_pair(ratio * wavelength, wavelength, tilt);
  for (double off = -88; off <= 88; off += 0.5) {
    const double angle = tilt + off * degree, phase = receiver_pair.phase(angle);
    const auto angles = receiver_pair.angles(phase);
    EXPECT_GE(angles.size(), 6);  // 2 * 3.2 turns contain 6 or 7
    EXPECT_LE(angles.size(), 7);
    EXPECT_TRUE(std::is_sorted(angles.begin(), angles.end()));
    double nearest = 10;
    for (const double candidate : angles) {
      EXPECT_NEAR(wrapped(receiver_pair.phase(candidate) - phase), 0, 1e-11);
      nearest = std::min(nearest, std::abs(candidate - angle));
    }
    EXPECT_LT(nearest, 1e-10);
    // An expected angle within half a turn of phase selects the correct angle.
    for (const double turns : {-0.49, 0.0, 0.49}) {
      const double expected_sine = std::sin(off * degree) + turns / ratio;
      if (std::abs(expected_sine) > 1) continue;
      const auto found = receiver_pair.angle_near(phase, tilt + std::asin(expected_sine));
      EXPECT_NEAR(found, angle, 1e-10);
    }
    const double far = std::sin(off * degree) + 0.51 / ratio;  // and a farther one selects the next
    if (far > 1 || std::sin(off * degree) + 1 / ratio > 1) continue;
    EXPECT_NEAR(std::sin(receiver_pair.angle_near(phase, tilt + std::asin(far)) - tilt),
                std::sin(off * degree) + 1 / ratio, 1e-10);
  }
}

// Noise may give a phase without an angle on the expected branch. There is an angle on another branch.
TEST(Interferometer, EveryPhaseHasAnAngleFromHalfAWavelengthOn) {
  for (const double ratio : {0.5, 0.75, 1.0, 3.2}) {
    const Interferometer receiver_pair(ratio * wavelength, wavelength, 30 * degree);
    for (double expected = -59; expected <= 119; expected += 1)
      for (double phase = -3.14; phase <= 3.14; phase += 0.01) {
        const double found = receiver_pair.angle_near(phase, expected * degree);
        ASSERT_NEAR(std::remainder(receiver_pair.phase(found) - phase, 2 * pi), 0, 1e-9)
            << ratio << " " << expected;
        // No other angle of the phase is nearer to the expected one.
        const double wanted = std::sin(expected * degree - 30 * degree),
                     got = std::abs(std::sin(found - 30 * degree) - wanted);
        for (const double other : receiver_pair.angles(phase))
          ASSERT_LE(got, std::abs(std::sin(other - 30 * degree) - wanted) + 1e-9);
      }
  }
}

TEST(Interferometer, APhaseThatNoWaveHasIsTheReceiverPairsEnd) {
  const Interferometer receiver_pair(wavelength / 4, wavelength, 0);  // phases up to pi / 2
  EXPECT_TRUE(receiver_pair.angles(3).empty());
  EXPECT_NEAR(receiver_pair.angle_near(3, 0.1), pi / 2,
              1e-12);  // the end of the receiver pair that is nearest in phase
  EXPECT_NEAR(receiver_pair.angle_near(-2, 0.1), -pi / 2, 1e-12);
  EXPECT_NEAR(receiver_pair.angles(pi / 2).at(0), pi / 2, 1e-6);
}

/// Angle below the horizontal at which slant range R meets a plane H below the receivers that falls away at
/// `slope`: R sin(angle) = H + R cos(angle) tan(slope).
double angle_on_plane(double height, double slope, double range) {
  return slope + std::asin(height * std::cos(slope) / range);
}

TEST(Interferometer, TiltedPlaneComesOutAtItsDepth) {
  const double height = 15;
  for (const double slope : {-10 * degree, 0.0, 8 * degree})
    for (const double baseline : {0.5 * wavelength, 2.5 * wavelength}) {
      const Interferometer receiver_pair(baseline, wavelength, 30 * degree);
      double expected = angle_on_plane(height, slope, 16);
      for (double range = 16; range < 60; range += 0.02) {
        const double angle = angle_on_plane(height, slope, range);
        InterferometricSample sample;
        sample.add(1e-10, baseline * std::sin(angle - 30 * degree), wavelength);
        const auto found = receiver_pair.angle_near(*sample.phase_rad(), expected);
        expected = found;  // the previous bin selects among the angles
        const DepthEstimate point = receiver_pair.point(range, found, 0);
        EXPECT_NEAR(point.depth_m, height + point.horizontal_m * std::tan(slope), 1e-9);
        EXPECT_NEAR(std::hypot(point.depth_m, point.horizontal_m), range, 1e-11);
        EXPECT_EQ(point.depth_sigma_m, 0);
      }
    }
}

TEST(Interferometer, ReceiversAtFiniteRangeAgreeToSecondOrder) {
  // The true paths to two receivers, half a baseline above and below the middle of a tilted receiver pair.
  const double baseline = 0.03, tilt = 25 * degree, range = 20;
  const Interferometer receiver_pair(baseline, wavelength, tilt);
  for (double angle = -20 * degree; angle < 85 * degree; angle += degree) {
    const double x = range * std::cos(angle), z = range * std::sin(angle);  // z down
    const double up_x = baseline / 2 * std::sin(tilt), up_z = -baseline / 2 * std::cos(tilt);
    const double difference = std::hypot(x - up_x, z - up_z) - std::hypot(x + up_x, z + up_z);
    InterferometricSample sample;
    sample.add(1, difference, wavelength);
    const auto found = receiver_pair.angle_near(*sample.phase_rad(), angle);
    const double off = angle - tilt;
    EXPECT_NEAR(found - angle, -std::pow(baseline / range, 2) / 8 * std::sin(off) * std::cos(off), 1e-11);
  }
}

TEST(Interferometer, PhaseNoiseBecomesAngleAndDepthNoise) {
  const std::uint64_t seed = 20261121;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const double coherence = 0.99, angle = 50 * degree, range = 30;
  const Interferometer receiver_pair(2 * wavelength, wavelength, 30 * degree);
  const double sigma = std::sqrt(phase_variance(coherence));
  EXPECT_NEAR(receiver_pair.angle_sigma(angle, 0.01), 0.01 / (4 * pi * std::cos(20 * degree)), 1e-15);
  EXPECT_NEAR(receiver_pair.angle_sigma(120 * degree, 0.01), pi / std::sqrt(12.0),
              1e-12);  // along the receiver pair
  std::vector<double> depths;
  const std::uint32_t n = 20000;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double phase =
        wrapped(receiver_pair.phase(angle) + draw_phase_error(SampleRandom(seed, 0, 0, i), coherence));
    depths.push_back(receiver_pair.point(range, receiver_pair.angle_near(phase, angle), sigma).depth_m);
  }
  const DepthEstimate point = receiver_pair.point(range, angle, sigma);
  EXPECT_DOUBLE_EQ(point.depth_m, range * std::sin(angle));
  EXPECT_DOUBLE_EQ(point.horizontal_m, range * std::cos(angle));
  EXPECT_DOUBLE_EQ(point.depth_sigma_m, point.horizontal_m * receiver_pair.angle_sigma(angle, sigma));
  EXPECT_NEAR(statistics::mean(depths), point.depth_m, 6 * point.depth_sigma_m / std::sqrt(n));
  // Heavy tails, fourth moment 37 sigma^4: six standard deviations of this estimate are 0.13.
  EXPECT_NEAR(std::sqrt(statistics::variance(depths)) / point.depth_sigma_m, 1, 0.15);
}

TEST(Interferometer, RefusesWhatIsNoReceiverPair) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  EXPECT_THROW(Interferometer(0, wavelength, 0), std::invalid_argument);
  EXPECT_THROW(Interferometer(1, 0, 0), std::invalid_argument);
  EXPECT_THROW(Interferometer(1, inf, 0), std::invalid_argument);
  EXPECT_THROW(Interferometer(nan, 1, 0), std::invalid_argument);
  EXPECT_THROW(Interferometer(1.1e4, 1, 0), std::invalid_argument);
  EXPECT_THROW(Interferometer(1, 1, nan), std::invalid_argument);
}

}  // namespace
}  // namespace tubefoot
