// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the compact storage of pings. Unpacking returns the same values, and rejects bytes that are not a
// ping of this run.
#include "run/checkpoint/packed_ping.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <libdeflate.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <random>
#include <utility>

namespace tubefoot {
namespace {

/// `with_further`: the layout has further channels, of which the store knows nothing but their sizes.
StoreLayout packed_layout(bool with_further) {
  StoreLayout made;
  made.sensors = {
      {5, {{"energy", 700, 2}}}, {5, {{"energy", 3}}}, {2, {{"energy", 1000, 4}}}, {5, {{"energy", 1}}}};
  made.groups = {{{0, 1, 3}, 5}, {{2}, 2}};
  if (with_further)
    for (StoreLayout::Sensor& sensor : made.sensors) {
      sensor.channels.push_back(sensor.channels.front());
      sensor.channels.back().name = "energy_bound";
      sensor.channels.push_back({"gradient.speed", 21, 3});
    }
  return made;
}

PingCounts counts() {
  PingCounts made;
  made.tubes = 12;
  made.echo_seconds = 0.25;
  made.refraction.largest_travel_path_error_m = 3;
  return made;
}

/// Values of each kind in each density, and runs of zeros of each length.
PingValues filled(const StoreLayout& packed_layout, std::size_t group, double lit, std::mt19937& random) {
  std::uniform_real_distribution<double> some(0, 1);
  PingValues made;
  made.clear(packed_layout, group);
  for (const std::size_t sensor : packed_layout.groups[group].sensors)
    for (const OutputChannel& channel : packed_layout.sensors[sensor].channels)
      for (double& value : made.of(sensor, channel.name))
        if (some(random) < lit)
          value = some(random) < 0.02   ? -0.0
                  : some(random) < 0.02 ? std::numeric_limits<double>::infinity()
                                        : std::exp(100 * some(random) - 80);
  return made;
}

bool same(std::span<const double> a, std::span<const double> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

TEST(PackedPings, ComeBackToTheBit) {
  std::mt19937 random(5);
  for (const bool with_further : {false, true})
    for (const double lit : {0.0, 0.01, 0.2, 0.5, 0.9, 1.0})
      for (const PingUnit& unit : {PingUnit{0, 3}, PingUnit{1, 1}}) {
        const StoreLayout all = packed_layout(with_further);
        const PingValues made = filled(all, unit.group, lit, random);
        PingValues back = filled(all, 1 - unit.group, 1, random);  // of an earlier ping
        const std::string packed = packed_ping(all, unit, counts(), made);
        EXPECT_EQ(packed, packed_ping(all, unit, counts(), made));
        const PackedHead head = head_of_packed(packed, all);
        EXPECT_EQ(head.unit.group, unit.group);
        EXPECT_EQ(head.unit.ping, unit.ping);
        const PingCounts taken = unpack_ping(packed, all, back);
        const PingCounts given = counts();
        EXPECT_EQ(std::memcmp(&taken, &given, sizeof given), 0);
        for (const std::size_t sensor : all.groups[unit.group].sensors)
          for (const auto& [channel, values, chunks, variables] : all.sensors[sensor].channels) {
            EXPECT_EQ(made.of(sensor, channel).size(), values);
            EXPECT_TRUE(same(made.of(sensor, channel), std::as_const(back).of(sensor, channel))) << lit;
          }
      }
}

TEST(PackedPings, AreSmallWhereLittleIsLit) {
  const StoreLayout all = packed_layout(false);
  PingValues made;
  made.clear(all, 1);
  for (std::size_t k = 0; k < 20; ++k) made.of(2, "energy")[k] = 1 + double(k);
  EXPECT_LT(packed_ping(all, {1, 0}, {}, made).size(), 600u);
}

TEST(PackedPings, WithAnyByteChangedOrCutAreRefused) {
  const StoreLayout all = packed_layout(true);
  PingValues back;
  std::mt19937 random(6);
  const std::string packed = packed_ping(all, {0, 1}, counts(), filled(all, 0, 0.1, random));
  for (std::size_t at = 0; at < packed.size(); ++at) {
    std::string damaged = packed;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
    EXPECT_THROW(unpack_ping(damaged, all, back), DamagedPing) << at;
    EXPECT_THROW(unpack_ping(packed.substr(0, at), all, back), DamagedPing) << at;
  }
  EXPECT_THROW(unpack_ping(packed + "x", all, back), DamagedPing);
  StoreLayout other = all;
  other.sensors[0].channels[0].values = 698;
  EXPECT_THROW(unpack_ping(packed, other, back), DamagedPing);
  StoreLayout shorter = all;
  shorter.groups[0].pings = 1;
  EXPECT_THROW(head_of_packed(packed, shorter), DamagedPing);
}

// A forger makes the checksums fit, so that the reader must trust no other field.
TEST(PackedPings, ThatWereForgedDoNoHarm) {
  const StoreLayout all = packed_layout(true);
  PingValues back;
  std::mt19937 random(7);
  const std::string packed = packed_ping(all, {0, 1}, counts(), filled(all, 0, 0.1, random));
  int refused = 0, taken = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::string forged = packed;
    PackedHead head;
    std::memcpy(&head, forged.data(), sizeof head);
    const auto place = [&](std::size_t end) {
      return sizeof head + std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
    };
    const std::size_t body = forged.size() - sizeof head;
    for (int k = 0; k < 1 + trial % 3; ++k)  // mostly in the counts and the lengths
      forged[place(trial % 2 == 0 ? std::min<std::size_t>(body, 400) : body)] = static_cast<char>(random());
    if (trial % 5 == 0) forged.resize(place(body) + 1);
    head.bytes = forged.size() - sizeof head;
    head.values_checksum = libdeflate_crc32(0, forged.data() + sizeof head, head.bytes);
    head.head_checksum = libdeflate_crc32(0, &head, offsetof(PackedHead, head_checksum));
    std::memcpy(forged.data(), &head, sizeof head);
    try {
      unpack_ping(forged, all, back);
      ++taken;
    } catch (const DamagedPing&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(taken, 10) << "else they are not forged well";
}

/// Replaces the header of a packed ping by one with intact checksums that claims `bytes` after it.
std::string with_forged_head(std::string packed, std::size_t bytes) {
  PackedHead head;
  std::memcpy(&head, packed.data(), sizeof head);
  head.bytes = bytes;
  head.values_checksum = libdeflate_crc32(0, packed.data() + sizeof head, packed.size() - sizeof head);
  head.head_checksum = libdeflate_crc32(0, &head, offsetof(PackedHead, head_checksum));
  std::memcpy(packed.data(), &head, sizeof head);
  return packed;
}

TEST(PackedPings, HaveAtMostTheLargestNumberOfBytes) {
  const StoreLayout all = packed_layout(true);
  std::mt19937 random(8);
  const std::string packed = packed_ping(all, {0, 1}, counts(), filled(all, 0, 0.1, random));
  const std::size_t most = most_packed(all, 0) - sizeof(PackedHead);
  EXPECT_EQ(head_of_packed(with_forged_head(packed, most), all).bytes, most);
  EXPECT_THROW(head_of_packed(with_forged_head(packed, most + 1), all), DamagedPing);
}

TEST(PackedPings, DoNotBelongToAHeaderOfAnotherLength) {
  const StoreLayout all = packed_layout(true);
  std::mt19937 random(9);
  const std::string packed = packed_ping(all, {0, 1}, counts(), filled(all, 0, 0.1, random));
  const std::size_t bytes = packed.size() - sizeof(PackedHead);
  for (const std::size_t claimed : {bytes - 1, bytes, bytes + 1}) {
    const PackedHead head = *intact_head(with_forged_head(packed, claimed));
    EXPECT_EQ(belongs_to(head, std::string_view(packed).substr(sizeof head)), claimed == bytes);
  }
}

TEST(PackedPings, WithChunkLengthsWhoseSumOverflowsAreRefused) {
  const StoreLayout all = packed_layout(true);
  std::mt19937 random(10);
  std::string packed = packed_ping(all, {0, 1}, counts(), filled(all, 0, 0.1, random));
  const std::size_t lengths_at = sizeof(PackedHead) + sizeof(PingCounts);
  std::uint64_t length[2];
  std::memcpy(length, packed.data() + lengths_at, sizeof length);
  length[1] += length[0] + 8;  // the sum modulo 2^64 stays the same
  length[0] = std::uint64_t{0} - 8;
  std::memcpy(packed.data() + lengths_at, length, sizeof length);
  const std::string forged = with_forged_head(packed, packed.size() - sizeof(PackedHead));
  EXPECT_THROW(checked_contents(forged, all), DamagedPing);
}

}  // namespace
}  // namespace tubefoot
