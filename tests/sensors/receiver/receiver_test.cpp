// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the receiver chain: levels of the sonar equation, noise, time-varied gain, reproducible and
// independent random numbers, and rejected input.

#include "sensors/receiver/receiver.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "fixtures/statistics.hpp"

namespace tubefoot {
namespace {

constexpr RangeSamples samples{5, 0.5, 100};

std::vector<double> some_energies(int beams) {
  std::mt19937_64 random(7);
  std::vector<double> energies;
  for (int i = 0; i < beams * samples.count; ++i)
    energies.push_back(i % 7 == 0 ? 0 : std::ldexp(double(random()), -64 - i % 900));
  return energies;
}

ReceiverDescription everything() {
  ReceiverDescription description;
  description.noise_level_db = 60;
  description.speckle = {SpeckleModel::k, 2, 3};
  description.tvg = TimeVariedGain{};
  description.seed = 11;
  return description;
}

TEST(ReceiverChain, OffByDefaultPassesTheVeryBits) {
  const auto energies = some_energies(3);
  EXPECT_EQ(ReceiverChain({}).receive(4, energies, samples), energies);
  EXPECT_EQ(ReceiverChain({}).noise_j(), 0);
}

TEST(ReceiverChain, LevelsAndAmplitudesOfTheSonarEquation) {
  ReceiverDescription description;
  description.source_level_db = 210;
  const ReceiverChain chain(description);
  EXPECT_DOUBLE_EQ(chain.level_db(1), 210);  // 1 J for a source of 1 J/sr at 1 m
  EXPECT_DOUBLE_EQ(chain.level_db(1e-10), 110);
  // A range bin of a flat Lambert seabed: mu -27 dB, height 10 m, 1.5 degrees, slant range 20 to 20.05 m.
  EXPECT_NEAR(chain.level_db(8.111093200e-11), 210 - 100.909206, 1e-6);
  EXPECT_DOUBLE_EQ(20 * std::log10(chain.amplitude_upa(1e-10)), 110);
  EXPECT_EQ(chain.level_db(0), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(chain.amplitude_upa(0), 0);

  description.display_gain = 2;
  description.display_offset_db = -150;
  EXPECT_DOUBLE_EQ(ReceiverChain(description).level_db(1e-10), 70);
  EXPECT_DOUBLE_EQ(20 * std::log10(ReceiverChain(description).amplitude_upa(1e-10)), 110);
}

TEST(ReceiverChain, NoiseStandsWhereItsLevelSays) {
  EXPECT_NEAR(thermal_noise_level_db(100, 1, 0), 25.00, 0.005);
  EXPECT_NEAR(thermal_noise_level_db(240, 1, 0), 32.60, 0.005);
  EXPECT_NEAR(thermal_noise_level_db(1100, 1, 0), 45.83, 0.005);
  EXPECT_NEAR(thermal_noise_level_db(1800, 1, 0), 50.11, 0.005);
  EXPECT_NEAR(thermal_noise_level_db(240, 1e4, 25), 32.60 + 40 - 25, 0.005);

  ReceiverDescription description;
  description.noise_level_db = 76;
  const ReceiverChain chain(description);
  EXPECT_NEAR(chain.noise_j(), 1e-13, 1e-26);
  EXPECT_NEAR(chain.level_db(chain.noise_j()), 76, 1e-9);
  const auto received = chain.receive(0, std::vector<double>(1000 * 100, 0.0), samples);
  EXPECT_NEAR(statistics::mean(received) / 1e-13, 1, 6 / std::sqrt(1e5));
}

TEST(TimeVariedGain, EvensOutSpreadingAndAbsorption) {
  TimeVariedGain gain;
  gain.spreading = 40;
  gain.absorption_db_per_km = 61.5;
  gain.gain_db = 7;
  ReceiverDescription description;
  description.tvg = gain;
  const ReceiverChain chain(description);
  // Point target of -20 dB in each range bin: EL = SL - 40 log R - 2 alpha R + TS.
  const RangeSamples far{10, 0.25, 400};
  std::vector<double> energies;
  for (int k = 0; k < far.count; ++k) {
    const double range = far.first_m + (k + 0.5) * far.step_m;
    energies.push_back(std::pow(10, (-40 * std::log10(range) - 2 * 0.0615 * range - 20) / 10));
  }
  for (const double energy : chain.receive(0, energies, far))
    EXPECT_NEAR(chain.level_db(energy), 206 - 20 + 7, 1e-9);
}

TEST(TimeVariedGain, FormulaHoldAndLimits) {
  TimeVariedGain gain;
  gain.absorption_db_per_km = 80;
  gain.gain_db = 3;
  EXPECT_DOUBLE_EQ(gain.at(100), 30 * 2 + 2 * 80 * 0.1 + 3);
  EXPECT_DOUBLE_EQ(gain.at(10), 30 + 1.6 + 3);
  EXPECT_EQ(gain.at(3), gain.at(10));
  EXPECT_EQ(gain.at(0), gain.at(10));
  EXPECT_LT(gain.at(10), gain.at(10.1));
  gain.most_db = 60;
  gain.least_db = 40;
  EXPECT_EQ(gain.at(1000), 60);
  EXPECT_EQ(gain.at(1), 40);
}

TEST(TimeVariedGain, AmplifiesNoiseAndEchoAlike) {
  ReceiverDescription description = everything();
  const auto energies = some_energies(2);
  const auto amplified = ReceiverChain(description).receive(3, energies, samples);
  const TimeVariedGain gain = *description.tvg;
  description.tvg.reset();
  const auto plain = ReceiverChain(description).receive(3, energies, samples);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    ASSERT_GT(plain[i], 0);
    EXPECT_NEAR(10 * std::log10(amplified[i] / plain[i]), gain.at(5.25 + 0.5 * double(i % 100)), 1e-9);
  }
}

TEST(ReceiverChain, DependsOnSeedAndPlaceAlone) {
  const ReceiverChain chain(everything());
  const auto energies = some_energies(4);
  const auto all = chain.receive(3, energies, samples);
  EXPECT_EQ(ReceiverChain(everything()).receive(3, energies, samples), all);
  // The other energies of a beam do not matter. Another ping or seed gives other noise.
  auto silent = energies;
  std::fill(silent.begin() + 100, silent.end(), 0.0);
  const auto first = chain.receive(3, silent, samples);
  EXPECT_TRUE(std::equal(first.begin(), first.begin() + 100, all.begin()));
  ReceiverDescription other = everything();
  other.seed = 12;
  const auto reseeded = ReceiverChain(other).receive(3, energies, samples),
             later = chain.receive(4, energies, samples);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_NE(all[i], reseeded[i]);
    EXPECT_NE(all[i], later[i]);
  }
}

TEST(ReceiverChain, NeighboursAreIndependent) {
  ReceiverDescription description;
  description.speckle.model = SpeckleModel::rayleigh;
  description.seed = 20261121;
  SCOPED_TRACE(testing::Message() << "seed " << description.seed);
  const std::size_t n = 200000;
  const auto ping = ReceiverChain(description).receive(0, std::vector<double>(n, 1.0), samples),
             next = ReceiverChain(description).receive(1, std::vector<double>(n, 1.0), samples);
  const auto lagged = [&](std::size_t lag) {
    return statistics::correlation({ping.begin(), ping.end() - lag}, {ping.begin() + lag, ping.end()});
  };
  const double none = 6.1 / std::sqrt(double(n));
  EXPECT_LT(std::abs(lagged(1)), none);    // adjacent range bin
  EXPECT_LT(std::abs(lagged(100)), none);  // the same range bin of the adjacent beam
  EXPECT_LT(std::abs(statistics::correlation(ping, next)), none);
}

template <typename Change>
std::string refusal(Change change) {
  ReceiverDescription description = everything();
  change(description);
  try {
    ReceiverChain chain(description);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ReceiverChain, RefusesWhatMakesNoReceiver) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  using R = ReceiverDescription;
  const auto contains = [](const char* part) { return testing::HasSubstr(part); };
  EXPECT_THAT(refusal([&](R& r) { r.source_level_db = nan; }), contains("source level is nan"));
  EXPECT_THAT(refusal([&](R& r) { r.noise_level_db = inf; }), contains("noise level is inf"));
  EXPECT_THAT(refusal([&](R& r) { r.speckle.looks = 0; }), contains("looks is 0"));
  EXPECT_THAT(refusal([&](R& r) { r.speckle.looks = 1025; }), contains("looks is 1025"));
  EXPECT_THAT(refusal([&](R& r) { r.speckle.shape = 0; }), contains("shape of the K distribution is 0"));
  EXPECT_THAT(refusal([&](R& r) { r.speckle.shape = inf; }), contains("shape of the K distribution is inf"));
  EXPECT_THAT(refusal([&](R& r) { r.display_gain = 0; }), contains("display gain is 0"));
  EXPECT_THAT(refusal([&](R& r) { r.display_offset_db = nan; }), contains("display offset is nan"));
  EXPECT_THAT(refusal([&](R& r) { r.tvg->spreading = -1; }), contains("spreading of the TVG is -1"));
  EXPECT_THAT(refusal([&](R& r) { r.tvg->absorption_db_per_km = nan; }),
              contains("absorption of the TVG is nan"));
  EXPECT_THAT(refusal([&](R& r) { r.tvg->gain_db = 1000; }), contains("gain of the TVG is 1000"));
  EXPECT_THAT(refusal([&](R& r) { r.tvg->fixed_below_m = 0; }), contains("nearest range of the TVG is 0"));
  EXPECT_THAT(refusal([&](R& r) { r.tvg->least_db = 301; }), contains("smallest gain of the TVG is 301"));
  EXPECT_THAT(refusal([&](R& r) { r.tvg->most_db = nan; }), contains("largest gain of the TVG is nan"));
  EXPECT_THAT(refusal([&](R& r) {
                r.tvg->most_db = -1;
                r.tvg->least_db = 1;
              }),
              contains("at most the largest gain"));
  EXPECT_EQ(refusal([&](R&) {}), "accepted");
}

TEST(ReceiverChain, RefusesWhatIsNoEnergyAndSaysWhere) {
  const ReceiverChain chain{ReceiverDescription{}};
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), -1e-300, std::numeric_limits<double>::infinity()}) {
    std::vector<double> energies(300, 1.0);
    energies[207] = bad;
    try {
      chain.receive(9, energies, samples);
      ADD_FAILURE() << "accepted " << bad;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("ping 9, beam 2, range bin 7"));
    }
  }
  EXPECT_THROW(chain.receive(0, std::vector<double>(150), samples), std::invalid_argument);
  EXPECT_THROW(chain.receive(0, std::vector<double>(150), {0, 1, 0}), std::invalid_argument);
}

TEST(ReceiverChain, QuantisesLevelsAfterTheGain) {
  ReceiverDescription description;
  description.source_level_db = 200;
  description.tvg = TimeVariedGain{0, 0, 10};
  description.quantiser.emplace(100, 163, 6);  // steps of 1 dB
  const ReceiverChain chain(description);
  std::vector<double> energies(100);
  for (int k = 0; k < 100; ++k) energies[k] = std::pow(10, (80.3 + k - 200) / 10);  // levels with gain
  energies[99] = 0;
  const auto received = chain.receive(0, energies, samples);
  for (int k = 0; k < 99; ++k) {
    const double level = std::round(90.3 + k);
    if (level <= 100)
      EXPECT_EQ(received[k], 0) << k;  // code 0
    else
      EXPECT_NEAR(chain.level_db(received[k]), std::min(level, 163.0), 1e-9) << k;
  }
  EXPECT_EQ(received[99], 0);
}

}  // namespace
}  // namespace tubefoot
