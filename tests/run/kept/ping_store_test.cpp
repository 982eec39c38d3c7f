// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/kept/ping_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

void fill(PingStore& store, std::size_t sensor, std::size_t ping) {
  for (const std::span<double> values : {store.energy(sensor, ping), store.bound(sensor, ping)})
    std::iota(values.begin(), values.end(), 1000.0 * double(sensor) + double(ping));
}

TEST(PingStore, KeepsPingsApartInMemoryAndInAFile) {
  TestFolder folder;
  for (const bool with_bounds : {false, true}) {
    PingStore memory(layout(with_bounds)), file(layout(with_bounds), folder / "pings", "me");
    for (PingStore* store : {&memory, &file}) {
      for (std::size_t s = 0; s < 3; ++s)
        for (std::size_t p = 0; p < layout(false).sensors[s].pings; ++p) fill(*store, s, p);
      for (std::size_t p = 0; p < 5; ++p) store->finish(0, p, {});
      EXPECT_EQ(store->done_units(), 5u);
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
    fill(store, 0, 3);
    fill(store, 1, 3);
    PingCounts counts;
    counts.footprints = 17;
    store.finish(0, 3, counts);
    fill(store, 2, 1);  // not finished
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
    fill(store, 0, p);
    store.finish(0, p, {});
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
