// SPDX-License-Identifier: GPL-3.0-or-later
// Tests `PingStore`, which stores finished pings in memory or in a file. It resumes ping by ping, keeps
// empty pings to the bit, and rejects damaged pings.

#include "run/checkpoint/ping_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <numeric>
#include <sstream>
#include <string>

#include "fixtures/program.hpp"

namespace tubefoot {
namespace {

/// `with_further`: the layout has further channels, of which the store knows nothing but their sizes.
StoreLayout stored_layout(bool with_further) {
  StoreLayout made;
  made.sensors = {{5, {{"energy", 700, 2}}}, {5, {{"energy", 3}}}, {2, {{"energy", 1000}}}};
  made.groups = {{{0, 1}, 5}, {{2}, 2}};
  if (with_further)
    for (StoreLayout::Sensor& sensor : made.sensors) {
      sensor.channels.push_back(sensor.channels.front());
      sensor.channels.back().name = "energy_bound";
      sensor.channels.push_back({"gradient.speed", 12, 3});
    }
  return made;
}

PingValues made(const StoreLayout& layout, std::size_t group, std::size_t ping) {
  PingValues values;
  values.clear(layout, group);
  for (const std::size_t sensor : layout.groups[group].sensors)
    for (const OutputChannel& channel : layout.sensors[sensor].channels) {
      const std::span<double> some = values.of(sensor, channel.name);
      std::iota(some.begin(), some.end(), 1000.0 * double(sensor) + double(ping));
    }
  return values;
}

/// Returns all values of an output channel of a ping.
std::vector<double> kept(const PingStore& store, std::size_t sensor, std::size_t ping,
                         std::string_view channel = "energy") {
  std::vector<double> all;
  const OutputChannel& stored = *store.find(sensor, channel);
  for (std::size_t chunk = 0; chunk < stored.chunks; ++chunk) {
    const std::shared_ptr<const double> values = store.values(ping, {sensor, channel, chunk});
    all.insert(all.end(), values.get(), values.get() + stored.values / stored.chunks);
  }
  return all;
}

std::unique_ptr<PingFile> opened(const std::filesystem::path& file) {
  return std::make_unique<PingFile>(file);
}

TEST(PingStore, KeepsPingsApartInMemoryAndInAFile) {
  TestFolder folder;
  for (const bool with_further : {false, true}) {
    const StoreLayout all = stored_layout(with_further);
    PingStore memory(all), file(all, opened(folder / (with_further ? "further" : "pings")), "me");
    for (PingStore* store : {&memory, &file}) {
      for (std::size_t g = 0; g < 2; ++g)
        for (std::size_t p = 0; p < all.groups[g].pings; ++p) store->finish(g, p, {}, made(all, g, p));
      EXPECT_EQ(store->done_units(), 7u);
      for (std::size_t s = 0; s < 3; ++s) {
        EXPECT_EQ(store->find(s, "energy_bound") != nullptr, with_further);
        for (const OutputChannel& channel : all.sensors[s].channels)
          for (std::size_t p = 0; p < all.sensors[s].pings; ++p) {
            std::vector<double> expected(channel.values);
            std::iota(expected.begin(), expected.end(), 1000.0 * double(s) + double(p));
            EXPECT_THAT(kept(*store, s, p, channel.name), testing::ElementsAreArray(expected));
            if (store == &memory) {
              EXPECT_EQ(memory.in_memory(s, channel.name)[p * expected.size()], expected[0]);
            }
          }
      }
    }
  }
}

TEST(PingStore, IsTakenUpAgainPingByPing) {
  TestFolder folder;
  const auto file = folder / "pings";
  {
    PingStore store(stored_layout(true), opened(file), "me");
    PingCounts counts;
    counts.footprints = 17;
    store.finish(0, 3, counts, made(stored_layout(true), 0, 3));
    EXPECT_TRUE(summary_of(file).in_use);
    EXPECT_THROW(opened(file), UnusableStore);
  }
  const StoreSummary summary = summary_of(file);
  EXPECT_EQ(summary.identity, "me");
  EXPECT_EQ(summary.done, 1u);
  EXPECT_FALSE(summary.in_use);
  EXPECT_THROW(PingStore(stored_layout(false), opened(file), "me"), UnusableStore);
  const auto again = std::make_unique<PingStore>(stored_layout(true), opened(file), "me");
  EXPECT_TRUE(again->done(0, 3));
  EXPECT_FALSE(again->done(1, 1));
  EXPECT_EQ(again->counts(0, 3).footprints, 17u);
  EXPECT_EQ(kept(*again, 0, 3)[2], 5);
  EXPECT_EQ(kept(*again, 1, 3, "energy_bound")[0], 1003);
  EXPECT_EQ(kept(*again, 0, 3, "gradient.speed")[11], 14);
}

// Tests pings without echoes, and zeros whose bits are not all zero.
TEST(PingStore, KeepsSilenceToTheBit) {
  TestFolder folder;
  StoreLayout line;
  line.sensors = {{3, {{"energy", 5000}, {"energy_bound", 5000}}}};
  line.groups = {{{0}, 3}};
  const auto few = [&](std::size_t ping) {
    PingValues values;
    values.clear(line, 0);
    for (const std::size_t cell : {std::size_t{0}, 700 + ping, std::size_t{4999}})
      values.of(0, "energy")[cell] = 1 + double(ping);
    values.of(0, "energy")[3000] = -0.0;
    values.of(0, "energy_bound")[2500] = 0.5;
    return values;
  };
  const auto expect_few = [&](const PingStore& store, std::size_t ping) {
    const PingValues expected = few(ping);
    for (const char* channel : {"energy", "energy_bound"}) {
      const std::span<const double> values = expected.of(0, channel);
      EXPECT_EQ(std::memcmp(store.values(ping, {0, channel}).get(), values.data(), values.size_bytes()), 0)
          << ping;
    }
  };
  PingStore memory(line), store(line, opened(folder / "pings"), "me");
  for (const std::size_t ping : {2, 0, 1})
    for (PingStore* one : {&memory, &store}) {
      one->finish(0, ping, {}, few(ping));
      expect_few(*one, ping);
    }
}

// The bytes of the middle one of three pings are changed. It is computed again and stored after the others.
TEST(PingStore, MakesDamagedPingsAgainAndKeepsTheOthers) {
  TestFolder folder;
  const StoreLayout all = stored_layout(true);
  const auto file = folder / "pings";
  std::string packed;
  {
    PingStore store(all, opened(file), "me");
    for (const std::size_t ping : {2, 0, 1}) store.finish(0, ping, {}, made(all, 0, ping));
    packed = packed_ping(all, {0, 0}, {}, made(all, 0, 0));
  }
  std::string bytes = bytes_of(file);
  const std::size_t at = bytes.find(packed);
  ASSERT_NE(at, std::string::npos) << "pings lie in the file as they are packed";
  for (const std::size_t damaged : {at, at + packed.size() / 2, at + packed.size() - 1}) {
    std::string other = bytes;
    other[damaged] = static_cast<char>(other[damaged] ^ 1);
    folder.write("pings", other);
    const auto again = std::make_unique<PingStore>(all, opened(file), "me");
    EXPECT_EQ(again->done_units(), 2u) << "of three";
    EXPECT_FALSE(again->done(0, 0));
    again->finish(0, 0, {}, made(all, 0, 0));
    for (std::size_t ping = 0; ping < 3; ++ping)
      EXPECT_EQ(kept(*again, 0, ping)[5], 5 + double(ping)) << ping;
  }
}

// Ranks and shards exchange pings in packed form.
TEST(PingStore, TakesPackedPingsOfThisRunOnly) {
  TestFolder folder;
  const StoreLayout all = stored_layout(true);
  PingStore memory(all), file(all, opened(folder / "pings"), "me");
  PingValues values = made(all, 0, 3);
  std::ranges::reverse(values.of(0, "gradient.speed"));
  PingCounts counts;
  counts.hits = 9;
  const std::string packed = packed_ping(all, {0, 3}, counts, values);
  for (PingStore* store : {&memory, &file}) {
    store->keep(packed);
    EXPECT_EQ(store->done_units(), 1u);
    EXPECT_EQ(store->counts(0, 3).hits, 9u);
    for (const char* channel : {"energy", "energy_bound", "gradient.speed"})
      EXPECT_THAT(kept(*store, 0, 3, channel), testing::ElementsAreArray(values.of(0, channel)));
    EXPECT_THAT(kept(*store, 1, 3, "energy_bound"), testing::ElementsAreArray(values.of(1, "energy_bound")));
    for (const std::size_t at : {std::size_t{0}, packed.size() / 2, packed.size() - 1}) {
      std::string damaged = packed;
      damaged[at] = static_cast<char>(damaged[at] ^ 1);
      EXPECT_THROW(store->keep(damaged), DamagedPing) << at;
    }
    EXPECT_THROW(store->keep(packed.substr(0, packed.size() - 1)), DamagedPing);
    EXPECT_EQ(store->done_units(), 1u);
  }
}

// A further output channel is one more entry of the layout: no other code of checkpoints and shards knows it.
TEST(PingStore, PassesAFurtherChannelThroughCheckpointAndShard) {
  TestFolder folder;
  StoreLayout all = stored_layout(false);
  all.sensors[1].channels.push_back({"gradient.sound_speed", 18, 3});
  const auto expect_all = [&](const PingStore& store) {
    EXPECT_EQ(store.done_units(), all.units());
    for (std::size_t ping = 0; ping < 5; ++ping) {
      const PingValues expected = made(all, 0, ping);
      for (const char* channel : {"energy", "gradient.sound_speed"})
        EXPECT_THAT(kept(store, 1, ping, channel), testing::ElementsAreArray(expected.of(1, channel)));
    }
  };
  const auto finish = [&](PingStore& store, std::size_t first, std::size_t end) {
    for (std::size_t group = 0; group < 2; ++group)
      for (std::size_t ping = first; ping < std::min(end, all.groups[group].pings); ++ping)
        store.finish(group, ping, {}, made(all, group, ping));
  };
  {
    PingStore interrupted(all, opened(folder / "checkpoint"), "me");
    finish(interrupted, 0, 2);
  }
  {
    PingStore resumed(all, opened(folder / "checkpoint"), "me");
    finish(resumed, 2, 5);
    expect_all(resumed);
  }
  PingFile shard(folder / "checkpoint", "shard");
  shard.look_through(all);
  PingStore joined(all);
  for (std::size_t group = 0; group < 2; ++group)
    for (std::size_t ping = 0; ping < all.groups[group].pings; ++ping) joined.keep(shard.read({group, ping}));
  expect_all(joined);
}

/// Returns the memory of a file mapping in KB, as the system reports it.
std::size_t mapped_kb(const std::filesystem::path& file) {
  std::ifstream maps("/proc/self/smaps");
  std::size_t kb = 0;
  bool ours = false;
  for (std::string line; std::getline(maps, line);) {
    // its figures follow
    const bool a_mapping = std::isupper(static_cast<unsigned char>(line.front())) == 0;
    if (a_mapping)
      ours = line.ends_with(std::filesystem::canonical(file).string());
    else if (line.starts_with("Rss:") && ours)
      kb += std::stoul(line.substr(4));
  }
  return kb;
}

TEST(PingStore, MapsNothingOfItsFile) {
  TestFolder folder;
  StoreLayout line;
  line.sensors = {{1000, {{"energy", 2000}}}};  // 16 MB of energies
  line.groups = {{{0}, 1000}};
  PingStore store(line, opened(folder / "pings"), "me");
  for (std::size_t p = 0; p < 1000; ++p) store.finish(0, p, {}, made(line, 0, p));
  double sum = 0;
  for (std::size_t p = 0; p < 1000; ++p)
    for (const double value : kept(store, 0, p)) sum += value;
  EXPECT_EQ(sum, 1000 * (1999.0 * 2000 / 2) + 2000 * (999.0 * 1000 / 2));
  EXPECT_EQ(mapped_kb(folder / "pings"), 0u);
}

}  // namespace
}  // namespace tubefoot
