// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that chunks are unpacked to the bit, and invalid chunks rejected. The tests of echoes.nc verify
// that HDF5 reads the chunks.
#include "files/hdf5_chunks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <iostream>
#include <limits>
#include <random>

namespace tubefoot {
namespace {

/// Returns values of which a share `lit` has random bits. The others are 0, some of them with a sign.
std::vector<double> some_values(std::size_t count, double lit, std::mt19937_64& random) {
  std::uniform_real_distribution<double> part(0, 1);
  std::vector<double> values(count);
  for (double& value : values)
    if (part(random) < lit) {
      const std::uint64_t bits = random();
      std::memcpy(&value, &bits, sizeof value);
    } else if (part(random) < 0.01) {
      value = -0.0;
    }
  return values;
}

TEST(Hdf5Chunks, AreUnpackedToTheBit) {
  const unsigned seed = std::random_device{}();
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  for (const std::size_t count : {0, 1, 7, 8, 9, 63, 64, 1000, 4097})
    for (const double lit : {0.0, 0.02, 0.5, 1.0}) {
      const std::vector<double> values = some_values(count, lit, random);
      const std::vector<unsigned char> packed = packed_chunk(values);
      EXPECT_LE(packed.size(), most_packed_bytes(count));
      std::vector<double> back(count, std::numeric_limits<double>::quiet_NaN());
      EXPECT_TRUE(unpack_chunk(packed, back)) << count;
      EXPECT_TRUE(std::equal(back.begin(), back.end(), values.begin(), [](double a, double b) {
        return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
      })) << count;
    }
}

TEST(Hdf5Chunks, OfOtherLengthsOrDamagedAreRefused) {
  std::mt19937_64 random(3);
  const std::vector<double> values = some_values(300, 0.3, random);
  const std::vector<unsigned char> packed = packed_chunk(values);
  std::vector<double> fewer(299), more(301), back(300);
  EXPECT_FALSE(unpack_chunk(packed, fewer));
  EXPECT_FALSE(unpack_chunk(packed, more));
  std::size_t meaningless = 0;
  for (std::size_t at = 0; at < packed.size(); ++at) {
    std::vector<unsigned char> damaged = packed;
    damaged[at] ^= 0x10;
    // Some bits of a stream have no meaning: after their change the values are the same.
    if (unpack_chunk(damaged, back)) {
      EXPECT_EQ(std::memcmp(back.data(), values.data(), 300 * sizeof(double)), 0) << at;
      ++meaningless;
    }
    EXPECT_FALSE(unpack_chunk({packed.data(), at}, back)) << at;
  }
  EXPECT_LT(meaningless, packed.size() / 20);
  std::vector<unsigned char> longer = packed;
  longer.push_back(0);
  EXPECT_FALSE(unpack_chunk(longer, back));
}

}  // namespace
}  // namespace tubefoot
