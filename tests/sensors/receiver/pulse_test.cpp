// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the pulse and the receiver: echoes spread over half the pulse length, energy conservation, and the
// time-varied gain.

#include "sensors/receiver/pulse.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "fixtures/world/recordings.hpp"
#include "sensors/products/received.hpp"
#include "sensors/receiver/lit_samples.hpp"

namespace tubefoot {
namespace {

constexpr RangeSamples window{2, 0.05, 400};

double sum(std::span<const double> values) { return std::accumulate(values.begin(), values.end(), 0.0); }

std::vector<double> one_echo(std::size_t at, double energy = 1) {
  std::vector<double> energies(400, 0.0);
  energies[at] = energy;
  return energies;
}

TEST(Pulse, ExtendsOverHalfItsLengthInWater) { EXPECT_DOUBLE_EQ(pulse_extent_m(100, 1500), 0.075); }

TEST(Pulse, EchoBecomesABoxThatBeginsWhereItCameFrom) {
  // 20 range bins: the extent of the bin itself rounds the ends of the box.
  const auto spread = spread_over_pulse(one_echo(100), window, 1.0);
  for (std::size_t k = 0; k < spread.size(); ++k) {
    const double expected = k < 100 || k > 120 ? 0 : k == 100 || k == 120 ? 0.025 : 0.05;
    EXPECT_NEAR(spread[k], expected, 1e-15) << k;
  }
}

TEST(Pulse, IsTheEchoAndTheBoxFoldedWhateverItsExtent) {
  // Compares with a sum over many points of the range bin and of the pulse.
  constexpr int points = 1000;
  for (const double extent_m : {0.013, 0.05, 0.0721, 0.333}) {
    std::vector<double> expected(400, 0.0);
    for (int a = 0; a < points; ++a)
      for (int b = 0; b < points; ++b)
        expected[static_cast<std::size_t>(100 + (a + 0.5) / points + (b + 0.5) / points * extent_m / 0.05)] +=
            1.0 / points / points;
    const auto spread = spread_over_pulse(one_echo(100), window, extent_m);
    for (std::size_t k = 0; k < spread.size(); ++k)
      EXPECT_NEAR(spread[k], expected[k], 1e-3) << extent_m << " " << k;
  }
}

TEST(Pulse, KeepsTheEnergyExceptWhatLeavesTheRangeGate) {
  std::mt19937_64 random(7);
  std::exponential_distribution<double> energy;
  for (const double extent_m : {1e-12, 0.001, 0.05, 0.0501, 0.7, 3.0}) {
    std::vector<double> energies(2 * 400, 0.0);
    for (std::size_t beam = 0; beam < 2; ++beam)
      for (std::size_t k = 0; k < 330; ++k) energies[400 * beam + k] = energy(random);
    const auto spread = spread_over_pulse(energies, window, extent_m);
    for (std::size_t beam = 0; beam < 2; ++beam) {
      const double before = sum(std::span(energies).subspan(400 * beam, 400));
      EXPECT_NEAR(sum(std::span(spread).subspan(400 * beam, 400)) / before, 1, 1e-13)
          << "seed 7, " << extent_m;
    }
  }
  // Half of a pulse of 20 range bins that begins 10 bins before the end leaves the range gate. Nothing
  // enters the next beam.
  std::vector<double> energies(800, 0.0);
  energies[390] = 1;
  const auto spread = spread_over_pulse(energies, window, 1.0);
  EXPECT_NEAR(sum(std::span(spread).first(400)), 9.5 / 20, 1e-14);
  EXPECT_EQ(sum(std::span(spread).last(400)), 0);
}

TEST(Pulse, RefusesWhatIsNone) {
  EXPECT_THROW(spread_over_pulse(one_echo(1), window, -1), std::invalid_argument);
  EXPECT_THROW(spread_over_pulse(one_echo(1), window, std::nan("")), std::invalid_argument);
  EXPECT_THROW(spread_over_pulse(std::vector<double>(401), window, 1), std::invalid_argument);
}

TEST(Received, WithoutAPulseKeepsTheBits) {
  auto made = samples::silent(samples::sidescan(20), 3);
  made.energy(1, 0, 7) = 1.0 / 3;
  made.energy(1, 1, 9) = 0.1;
  const auto received = ReceivedPings(made.recording, {}).of(1);
  const PingEnergies kept = made.recording.energy_of(1);
  EXPECT_THAT(received, testing::ElementsAreArray(kept.values()));
}

TEST(Received, GainIsFixedBelowTheRangeOfItsKey) {
  SensorDescription description = samples::sidescan(990);
  description.signal.tvg_spreading = 40;
  description.signal.tvg_absorption_db_per_km = 0;
  description.signal.tvg_fixed_below_m = 2;
  auto made = samples::silent(description, 1);
  std::fill(made.energies.begin(), made.energies.end(), 1e-9);
  const auto received = ReceivedPings(made.recording, {}).of(0);
  EXPECT_NEAR(received[10] / 1e-9, std::pow(2, 4), 1e-9);  // at 1.025 m
  EXPECT_NEAR(received[90] / 1e-9, std::pow(5.025, 4), 1e-7);
}

TEST(Received, SpreadsOverThePulseAndItsLevelIsThatOfThePulse) {
  SensorDescription description = samples::sidescan(990);  // range bins of 5 cm
  description.signal.pulse_length_us = 1000;               // 0.74 m at 1480 m/s
  auto made = samples::silent(description, 2);
  made.energy(1, 1, 500) = 1e-8;
  const auto received = ReceivedPings(made.recording, {}).of(1);
  EXPECT_NEAR(sum(received), 1e-8, 1e-21);
  EXPECT_NEAR(received[990 + 507], 1e-8 * 0.05 / 0.74, 1e-19);
  EXPECT_EQ(received[990 + 499], 0);
  // A long pulse has 14.8 times the energy of a pulse as long as a range bin, spread over as many bins. The
  // echo of a point thus has the level of its target strength, 210 + 10 log10(1e-8) dB.
  EXPECT_NEAR(receiver_of(made.recording, {}).level_db(received[990 + 507]), 130, 1e-9);
}

// A single beam is received as among the others, except for the empty bins after its last echo.
TEST(Received, ABeamAloneIsThatOfItsPing) {
  for (const bool noise : {false, true})
    for (const bool speckle : {false, true})
      for (const double pulse_us : {0.0, 700.0}) {
        SensorDescription description = samples::sidescan(990);
        description.signal.tvg_spreading = 30;
        if (noise) description.signal.noise_level_db = 90;
        if (speckle) description.signal.speckle = "rayleigh";
        if (pulse_us > 0) description.signal.pulse_length_us = pulse_us;
        auto made = samples::silent(description, 3);
        made.energy(2, 0, 100) = 1e-9;
        made.energy(2, 1, 3) = 2e-9;
        made.energy(2, 1, 700) = 1e-8;
        const ReceivedPings received(made.recording, {});
        const std::vector<double> all = received.of(2);
        const PingEnergies energies = made.recording.energy_of(2);
        for (std::size_t beam = 0; beam < 2; ++beam) {
          const auto alone = received.of_beam(2, beam, energies);
          const std::size_t silence = noise ? 990 : (beam == 0 ? 100 : 700) + 1 + (pulse_us > 0 ? 11 : 0);
          EXPECT_EQ(alone.size(), silence);
          for (std::size_t k = 0; k < 990; ++k)
            ASSERT_EQ(k < alone.size() ? alone[k] : 0, all[990 * beam + k]) << beam << ", " << k;
        }
      }
}

TEST(LitSamples, AreThoseFromTheFirstToTheLastThatIsNotZero) {
  std::mt19937 random(3);
  std::uniform_int_distribution<std::size_t> size(0, 40), kind(0, 29);
  const double odd[] = {std::nan(""), -1, 5e-324, -std::numeric_limits<double>::infinity()};
  for (int trial = 0; trial < 3000; ++trial) {
    std::vector<double> values(size(random), 0.0);
    for (double& value : values) {
      const std::size_t draw = kind(random);
      if (draw < 4) value = odd[draw];
      if (draw == 5) value = -0.0;
    }
    const auto is_lit = [](double value) { return value != 0; };
    const auto first = std::ranges::find_if(values, is_lit);
    const auto last = std::find_if(values.rbegin(), values.rend(), is_lit);
    const LitSpan lit = lit_samples(values);
    if (first == values.end()) {
      EXPECT_TRUE(lit.empty());
      continue;
    }
    EXPECT_EQ(lit.begin, static_cast<std::size_t>(first - values.begin()));
    EXPECT_EQ(lit.end, static_cast<std::size_t>(values.rend() - last));
  }
}

}  // namespace
}  // namespace tubefoot
