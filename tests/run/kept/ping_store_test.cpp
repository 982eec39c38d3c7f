// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/kept/ping_store.hpp"

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

StoreLayout layout(bool with_bounds) {
  StoreLayout made;
  made.sensors = {{5, 700}, {5, 3}, {2, 1000}};
  made.groups = {{{0, 1}, 5}, {{2}, 2}};
  made.with_bounds = with_bounds;
  return made;
}

PingValues made(const StoreLayout& layout, std::size_t group, std::size_t ping) {
  PingValues values;
  values.clear(layout, group);
  for (const std::size_t sensor : layout.groups[group].sensors)
    for (const std::span<double> some : {values.energy(sensor), values.bound(sensor)})
      std::iota(some.begin(), some.end(), 1000.0 * double(sensor) + double(ping));
  return values;
}

TEST(PingStore, KeepsPingsApartInMemoryAndInAFile) {
  TestFolder folder;
  for (const bool with_bounds : {false, true}) {
    PingStore memory(layout(with_bounds)), file(layout(with_bounds), folder / "pings", "me");
    for (PingStore* store : {&memory, &file}) {
      for (std::size_t g = 0; g < 2; ++g)
        for (std::size_t p = 0; p < layout(false).groups[g].pings; ++p)
          store->finish(g, p, {}, made(layout(with_bounds), g, p));
      EXPECT_EQ(store->done_units(), 7u);
      for (std::size_t s = 0; s < 3; ++s)
        for (std::size_t p = 0; p < layout(false).sensors[s].pings; ++p) {
          store->release(s, p);
          std::vector<double> expected(layout(false).sensors[s].cells);
          std::iota(expected.begin(), expected.end(), 1000.0 * double(s) + double(p));
          EXPECT_THAT(store->energy(s, p), testing::ElementsAreArray(expected));
          EXPECT_EQ(store->energy(s).subspan(p * expected.size(), 1)[0], expected[0]);
          if (with_bounds)
            EXPECT_THAT(store->bound(s, p), testing::ElementsAreArray(expected));
          else
            EXPECT_TRUE(store->bound(s, p).empty());
        }
    }
  }
}

TEST(PingStore, IsTakenUpAgainPingByPing) {
  TestFolder folder;
  const auto file = folder / "pings";
  {
    PingStore store(layout(true), file, "me");
    PingCounts counts;
    counts.footprints = 17;
    store.finish(0, 3, counts, made(layout(true), 0, 3));
    EXPECT_TRUE(summary_of(file).in_use);
    EXPECT_THROW(PingStore::reopen(layout(true), file), UnusableStore);
  }
  const StoreSummary summary = summary_of(file);
  EXPECT_EQ(summary.identity, "me");
  EXPECT_EQ(summary.units, 7u);
  EXPECT_EQ(summary.done, 1u);
  EXPECT_FALSE(summary.in_use);
  EXPECT_THROW(PingStore::reopen(layout(false), file), UnusableStore);
  const auto again = PingStore::reopen(layout(true), file);
  EXPECT_TRUE(again->done(0, 3));
  EXPECT_FALSE(again->done(1, 1));
  EXPECT_EQ(again->counts(0, 3).footprints, 17u);
  EXPECT_EQ(again->energy(0, 3)[2], 5);
  EXPECT_EQ(again->bound(1, 3)[0], 1003);
}

// In memory, what is silent is left out; in a file, it takes the place of what was there.
TEST(PingStore, KeepsSilenceWhateverWasThere) {
  TestFolder folder;
  StoreLayout line;
  line.sensors = {{3, 5000}};  // pages shared with neighbours
  line.groups = {{{0}, 3}};
  line.with_bounds = true;
  const auto few = [&](std::size_t ping) {
    PingValues values;
    values.clear(line, 0);
    for (const std::size_t cell : {std::size_t{0}, 700 + ping, std::size_t{4999}})
      values.energy(0)[cell] = 1 + double(ping);
    values.energy(0)[3000] = -0.0;
    values.bound(0)[2500] = 0.5;
    return values;
  };
  const auto expect_few = [&](const PingStore& store, std::size_t ping) {
    const PingValues expected = few(ping);
    EXPECT_EQ(std::memcmp(store.energy(0, ping).data(), expected.energy(0).data(), 5000 * sizeof(double)), 0)
        << ping;
    EXPECT_EQ(std::memcmp(store.bound(0, ping).data(), expected.bound(0).data(), 5000 * sizeof(double)), 0)
        << ping;
  };
  const auto file = folder / "pings";
  {
    PingStore memory(line), store(line, file, "me");
    for (const std::size_t ping : {2, 0}) {
      store.finish(0, ping, {}, few(ping));
      memory.finish(0, ping, {}, few(ping));
      expect_few(memory, ping);
    }
    PingValues loud;
    loud.clear(line, 0);
    std::ranges::fill(loud.energy(0), 7.0);
    store.finish(0, 1, {}, loud);
    for (const std::size_t ping : {0, 2}) expect_few(store, ping);
  }
  std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).seekp(-70000, std::ios::end).put('x');
  const auto again = PingStore::reopen(line, file);
  ASSERT_EQ(again->done_units(), 2u) << "one ping was damaged";
  for (std::size_t ping = 0; ping < 3; ++ping) {
    if (!again->done(0, ping)) again->finish(0, ping, {}, few(ping));
    if (ping != 1) expect_few(*again, ping);
  }
}

/// Memory that a mapping of a file takes, in KB, as the system counts it.
std::size_t mapped_kb(const std::filesystem::path& file) {
  std::ifstream maps("/proc/self/smaps");
  std::size_t kb = 0;
  bool ours = false;
  for (std::string line; std::getline(maps, line);) {
    const bool a_mapping = std::isupper(static_cast<unsigned char>(line.front())) == 0;  // its figures follow
    if (a_mapping)
      ours = line.ends_with(std::filesystem::canonical(file).string());
    else if (line.starts_with("Rss:") && ours)
      kb += std::stoul(line.substr(4));
  }
  return kb;
}

TEST(PingStore, HoldsNoMorePagesThanThePingsAtHand) {
  TestFolder folder;
  StoreLayout line;
  line.sensors = {{1000, 2000}};  // 16 MB, four pages a ping, the last ones shared with the next
  line.groups = {{{0}, 1000}};
  PingStore store(line, folder / "pings", "me");
  for (std::size_t p = 0; p < 1000; ++p) {
    store.finish(0, p, {}, made(line, 0, p));
  }
  const std::size_t finished = mapped_kb(folder / "pings");
  EXPECT_GT(finished, 0u);  // the counts of pings, at least
  EXPECT_LT(finished, 1000u);
  double sum = 0;
  for (std::size_t p = 0; p < 1000; ++p) {
    for (const double value : store.energy(0, p)) sum += value;
    store.release(0, p);
  }
  EXPECT_EQ(sum, 1000 * (1999.0 * 2000 / 2) + 2000 * (999.0 * 1000 / 2));
  EXPECT_LT(mapped_kb(folder / "pings"), 1000u);
}

}  // namespace
}  // namespace tubefoot
