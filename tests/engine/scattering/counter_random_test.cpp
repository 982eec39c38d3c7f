// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/counter_random.hpp"

#include <gtest/gtest.h>

#include <set>

#include "fixtures/statistics.hpp"

namespace tubefoot {
namespace {

TEST(Philox, KnownAnswersOfItsAuthors) {  // the three philox4x32 10 lines of Random123's kat_vectors
  using Words = std::array<std::uint32_t, 4>;
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox4x32({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(SampleRandom, TakesTheTop52BitsOfTwoWordsAndAHalf) {
  // Values of the first known answer: range bin, beam, ping, purpose, draw and seed are all zero.
  const auto pair = SampleRandom(0, 0, 0, 0).uniform_pair(Purpose::speckle);
  EXPECT_EQ(pair[0], (double(0xe169c58d6627e8d5 >> 12) + 0.5) / double(1ull << 52));
  EXPECT_EQ(pair[1], (double(0x9b00dbd8bc57ac4c >> 12) + 0.5) / double(1ull << 52));
}

TEST(SampleRandom, EveryPartOfThePlaceAndOfTheSeedCounts) {
  std::set<double> seen;
  const std::uint64_t seeds[] = {1, 2, 1ull << 32, 1ull << 63};
  int drawn = 0;
  for (const std::uint64_t seed : seeds)
    for (std::uint32_t ping : {0u, 1u, 0xffffffffu})
      for (std::uint32_t beam : {0u, 1u, 0xffffu})
        for (std::uint32_t sample : {0u, 1u, 0xffffffu})
          for (const Purpose purpose : {Purpose::speckle, Purpose::texture, Purpose::noise, Purpose::phase})
            for (std::uint32_t draw : {0u, 1u, 0xffffffu})
              for (const double uniform :
                   SampleRandom(seed, ping, beam, sample).uniform_pair(purpose, draw)) {
                EXPECT_GT(uniform, 0);
                EXPECT_LT(uniform, 1);
                seen.insert(uniform);
                ++drawn;
              }
  EXPECT_EQ(seen.size(), drawn);
}

TEST(SampleRandom, NumbersAreUniformAndNeighboursUncorrelated) {
  const std::uint64_t seed = 20261121;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const std::uint32_t n = 200000;
  std::vector<double> here, second, next_sample, next_beam, next_ping, next_seed, other_purpose, next_draw;
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t sample = i % 500, beam = i / 500 % 100, ping = i / 50000;
    const auto pair = SampleRandom(seed, ping, beam, sample).uniform_pair(Purpose::speckle);
    here.push_back(pair[0]);
    second.push_back(pair[1]);
    next_sample.push_back(SampleRandom(seed, ping, beam, sample + 1).uniform_pair(Purpose::speckle)[0]);
    next_beam.push_back(SampleRandom(seed, ping, beam + 1, sample).uniform_pair(Purpose::speckle)[0]);
    next_ping.push_back(SampleRandom(seed, ping + 1, beam, sample).uniform_pair(Purpose::speckle)[0]);
    next_seed.push_back(SampleRandom(seed + 1, ping, beam, sample).uniform_pair(Purpose::speckle)[0]);
    other_purpose.push_back(SampleRandom(seed, ping, beam, sample).uniform_pair(Purpose::texture)[0]);
    next_draw.push_back(SampleRandom(seed, ping, beam, sample).uniform_pair(Purpose::speckle, 1)[0]);
  }
  const auto identity = [](double u) { return u; };
  const double limit = statistics::kolmogorov_limit(n);
  EXPECT_LT(statistics::kolmogorov_distance(here, identity), limit);
  EXPECT_LT(statistics::kolmogorov_distance(second, identity), limit);
  // 6.1 standard deviations of a correlation of independent numbers: about 1e-9.
  const double none = 6.1 / std::sqrt(n);
  for (const auto* other :
       {&second, &next_sample, &next_beam, &next_ping, &next_seed, &other_purpose, &next_draw})
    EXPECT_LT(std::abs(statistics::correlation(here, *other)), none);
}

}  // namespace
}  // namespace tubefoot
