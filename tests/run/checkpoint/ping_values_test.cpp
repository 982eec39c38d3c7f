// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that a ping starts with zeros, whatever an earlier ping has left in the memory.
#include "run/checkpoint/ping_values.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>
#include <utility>
#include <vector>

namespace tubefoot {
namespace {

StoreLayout layout(bool with_bounds) {
  StoreLayout made;
  made.sensors = {{4, 60}, {4, 7}, {2, 67}, {2, 200}};
  made.groups = {{{0, 1}, 4}, {{2}, 2}, {{3}, 2}};  // the first two take the same memory
  made.with_bounds = with_bounds;
  return made;
}

bool all_zero(const PingValues& values, const StoreLayout& all) {
  for (std::size_t sensor = 0; sensor < all.sensors.size(); ++sensor)
    for (const std::span<const double> block : {values.energy(sensor), values.bound(sensor)})
      if (std::ranges::any_of(block, [](double value) { return value != 0; })) return false;
  return true;
}

TEST(PingValues, BeginWithZerosWhateverWasWrittenBefore) {
  const unsigned seed = 20261124;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  for (const bool with_bounds : {false, true}) {
    const StoreLayout all = layout(with_bounds);
    PingValues values;
    for (int ping = 0; ping < 300; ++ping) {
      const std::size_t group = random() % all.groups.size();
      values.clear(all, group);
      ASSERT_TRUE(all_zero(values, all)) << ping;
      for (const std::size_t sensor : all.groups[group].sensors) {
        const std::size_t cells = all.sensors[sensor].cells;
        ASSERT_EQ(std::as_const(values).energy(sensor).size(), cells);
        for (std::size_t part = random() % 4; part > 0; --part) {
          const std::size_t first = random() % cells, count = random() % (cells - first + 1);
          const std::span<double> some = values.energy(sensor, first, count);
          ASSERT_EQ(some.size(), count);
          std::ranges::fill(some, 1 + ping);
          for (std::size_t k = 0; k < count; ++k)
            ASSERT_EQ(std::as_const(values).energy(sensor)[first + k], 1 + ping);
        }
        if (random() % 4 == 0) values.energy(sensor)[random() % cells] = 5;
        if (with_bounds && random() % 4 == 0) values.bound(sensor)[random() % cells] = 5;
      }
    }
  }
}

TEST(PingValues, BeginWithZerosAfterVeryManyParts) {
  StoreLayout one;
  one.sensors = {{1, 70000}};
  one.groups = {{{0}, 1}};
  PingValues values;
  values.clear(one, 0);
  for (std::size_t cell = 0; cell < 70000; ++cell) values.energy(0, cell, 1)[0] = 1;
  values.clear(one, 0);
  EXPECT_TRUE(all_zero(values, one));
}

TEST(PingValues, LendTheSameMemoryForEcho) {
  PingValues values;
  EXPECT_TRUE(values.take_echo_room().empty());
  std::vector<double> room(100);
  const double* place = room.data();
  values.give_back_echo_room(std::move(room));
  EXPECT_EQ(values.take_echo_room().data(), place);
  EXPECT_TRUE(values.take_echo_room().empty()) << "who waits within a ping may not get what another has";
}

}  // namespace
}  // namespace tubefoot
