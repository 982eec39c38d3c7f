// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that a ping starts with zeros, whatever an earlier ping has left in the memory.
#include "run/checkpoint/ping_values.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

namespace tubefoot {
namespace {

StoreLayout layout(bool with_bounds) {
  StoreLayout made;
  for (const auto& [pings, values] : {std::pair{4, 60}, {4, 7}, {2, 67}, {2, 200}}) {
    StoreLayout::Sensor& sensor = made.sensors.emplace_back();
    sensor.pings = std::size_t(pings);
    sensor.channels.push_back({"energy", std::size_t(values)});
    if (with_bounds) sensor.channels.push_back({"energy_bound", std::size_t(values)});
  }
  made.groups = {{{0, 1}, 4}, {{2}, 2}, {{3}, 2}};  // the first two take the same memory
  return made;
}

bool all_zero(const PingValues& values, const StoreLayout& all, std::size_t group) {
  for (const std::size_t sensor : all.groups[group].sensors)
    for (const OutputChannel& channel : all.sensors[sensor].channels)
      if (std::ranges::any_of(values.of(sensor, channel.name), [](double value) { return value != 0; }))
        return false;
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
      ASSERT_TRUE(all_zero(values, all, group)) << ping;
      for (const std::size_t sensor : all.groups[group].sensors) {
        const std::size_t cells = all.sensors[sensor].channels[0].values;
        ASSERT_EQ(std::as_const(values).of(sensor, "energy").size(), cells);
        for (std::size_t part = random() % 4; part > 0; --part) {
          const std::size_t first = random() % cells, count = random() % (cells - first + 1);
          const std::span<double> some = values.of(sensor, "energy", first, count);
          ASSERT_EQ(some.size(), count);
          std::ranges::fill(some, 1 + ping);
          for (std::size_t k = 0; k < count; ++k)
            ASSERT_EQ(std::as_const(values).of(sensor, "energy")[first + k], 1 + ping);
        }
        if (random() % 4 == 0) values.of(sensor, "energy")[random() % cells] = 5;
        if (with_bounds && random() % 4 == 0) values.of(sensor, "energy_bound")[random() % cells] = 5;
      }
    }
  }
}

TEST(PingValues, HaveOnlyTheChannelsOfTheirGroup) {
  PingValues values;
  values.clear(layout(false), 1);
  EXPECT_EQ(values.of(2, "energy").size(), 67u);
  EXPECT_THROW(values.of(2, "energy_bound"), std::out_of_range);
  EXPECT_THROW(values.of(0, "energy"), std::out_of_range);
}

TEST(PingValues, BeginWithZerosAfterVeryManyParts) {
  StoreLayout one;
  one.sensors = {{1, {{"energy", 70000}}}};
  one.groups = {{{0}, 1}};
  PingValues values;
  values.clear(one, 0);
  for (std::size_t cell = 0; cell < 70000; ++cell) values.of(0, "energy", cell, 1)[0] = 1;
  values.clear(one, 0);
  EXPECT_TRUE(all_zero(values, one, 0));
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
