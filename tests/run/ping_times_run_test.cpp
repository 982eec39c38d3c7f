// SPDX-License-Identifier: GPL-3.0-or-later
// Tests runs with listed times of pings: their energies are those of sensors with one ping each.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/world/echoes.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;

/// A camera that moves over a slope, with these keys of its times.
std::string moving_scene(const std::string& times) {
  return R"([[materials]]
name = "sand"
lambert_db = -22
[[terrain]]
kind = "flat"
width_m = 60
length_m = 60
slope_deg = 6
[trajectory]
kind = "waypoints"
file = "track.csv"
[[sensors]]
name = "camera"
kind = "imaging"
horizontal_deg = 30
beams = 6
samples = 60
range_min_m = 2
range_max_m = 14
tilt_deg = 30
)" + times;
}

TEST(PingTimesRun, GivesTheEnergiesOfSinglePings) {
  const TestFolder folder;
  folder.write("track.csv",
               "time_s,east_m,north_m,up_m,heading_deg,pitch_deg,roll_deg\n"
               "-1,0,-4,4,0,0,0\n2,1,1,5,20,2,-3\n5,3,2,4.5,50,-2,4\n");
  const std::vector<double> times_s{-0.5, 0.125, 3.75};
  const Echoes listed = echoes_in(folder, moving_scene("ping_times_s = [-0.5, 0.125, 3.75]\n"));
  ASSERT_EQ(listed.pings, 3u);
  EXPECT_THAT(listed.ping_time_s, ElementsAre(-0.5, 0.125, 3.75));
  const std::size_t cells = listed.beams * listed.samples;
  for (std::size_t ping = 0; ping < times_s.size(); ++ping) {
    const Echoes single = echoes_in(folder, moving_scene(fmt::format("first_ping_s = {}\n", times_s[ping])));
    ASSERT_EQ(single.energy.size(), cells);
    EXPECT_GT(single.total(), 0);
    const auto begin = listed.energy.begin() + std::ptrdiff_t(ping * cells);
    EXPECT_EQ(std::vector<double>(begin, begin + std::ptrdiff_t(cells)), single.energy) << "ping " << ping;
  }
  // The pings differ.
  EXPECT_NE(std::vector<double>(listed.energy.begin(), listed.energy.begin() + std::ptrdiff_t(cells)),
            std::vector<double>(listed.energy.end() - std::ptrdiff_t(cells), listed.energy.end()));
}

TEST(PingTimesRun, BeyondTheTrajectoryIsRejected) {
  const TestFolder folder;
  folder.write("track.csv", "time_s,east_m,north_m,up_m\n0,0,-4,4\n5,3,2,4.5\n");
  folder.write("scene.toml", moving_scene("ping_times_s = [1, 6]\n"));
  const Outcome outcome = run_program({"check", (folder / "scene.toml").string()});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, testing::HasSubstr("change ping_times_s"));
}

}  // namespace
}  // namespace tubefoot
