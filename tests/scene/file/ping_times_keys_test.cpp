// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the key `ping_times_s`: its values, its conflicts with other keys, and its order.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/world/read_scenes.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

std::string scene_with_times(const std::string& keys) { return std::string(smallest_scene) + keys + "\n"; }

TEST(PingTimesKey, ListsTheTimesOfThePings) {
  const TestFolder folder;
  const SensorDescription listed =
      read_scene(folder, scene_with_times("ping_times_s = [-3.5, 0, 1e-6, 7]")).sensors.at(0);
  EXPECT_THAT(listed.ping_times_s, ElementsAre(-3.5, 0, 1e-6, 7));
  EXPECT_TRUE(listed.has_several_pings());
  EXPECT_NEAR(listed.shortest_interval_s(), 1e-6, 1e-15);
  const SensorDescription one = read_scene(folder, scene_with_times("ping_times_s = [5]")).sensors.at(0);
  EXPECT_THAT(one.ping_times_s, ElementsAre(5));
  EXPECT_FALSE(one.has_several_pings());
  EXPECT_THAT(read_scene(folder, smallest_scene).sensors.at(0).ping_times_s, IsEmpty());
}

TEST(PingTimesKey, ConflictsWithTheOtherKeysOfTimes) {
  const TestFolder folder;
  for (const auto& [key, value] :
       {std::pair("first_ping_s", "1.5"), std::pair("pings", "3"), std::pair("ping_interval_s", "0.5")}) {
    const std::string keys = std::string("ping_times_s = [1, 2]\n") + key + " = " + value;
    EXPECT_THAT(scene_error(folder, scene_with_times(keys)),
                AllOf(StartsWith("scene.toml:13:"), HasSubstr("'ping_times_s' already sets"),
                      HasSubstr(std::string("remove '") + key + "' or the list")));
  }
}

TEST(PingTimesKey, MustIncrease) {
  const TestFolder folder;
  for (const char* times : {"[1, 1]", "[1, 2, 1.5]", "[0, 5e-7]", "[3, -3]"})
    EXPECT_THAT(scene_error(folder, scene_with_times(std::string("ping_times_s = ") + times)),
                AllOf(StartsWith("scene.toml:12:"), HasSubstr("must increase by at least 1e-06 s")))
        << times;
  EXPECT_THAT(scene_error(folder, scene_with_times("ping_times_s = [1, 2, 1.5]")),
              HasSubstr("1.5 follows 2"));
}

TEST(PingTimesKey, TakesNumbersInItsRangeOnly) {
  const TestFolder folder;
  for (const char* times : {"3", "\"1, 2\"", "[1, \"2\"]", "[nan]", "[1e11]", "[1, inf]"})
    EXPECT_THAT(scene_error(folder, scene_with_times(std::string("ping_times_s = ") + times)),
                AllOf(StartsWith("scene.toml:12:"), HasSubstr("ping_times_s")))
        << times;
}

}  // namespace
}  // namespace tubefoot
