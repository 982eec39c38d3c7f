// SPDX-License-Identifier: GPL-3.0-or-later
// Sensors that fire the same tubes from the same places read one history: the tubes are computed once.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/echo_reader.hpp"

namespace tubefoot {
namespace {

constexpr std::string_view scenery = R"(
[[materials]]
name = "sand"
[[terrain]]
kind = "fractal"
width_m = 20
length_m = 24
cell_m = 0.5
[[objects]]
name = "ball"
shape = "sphere"
radius_m = 0.5
position_m = [0, 4, 0.3]
[trajectory]
kind = "line"
start_m = [0, -1, 2]
end_m = [0, 1, 2]
)";

std::string camera(const std::string& name, const std::string& differences) {
  return fmt::format(
      "[[sensors]]\nname = \"{}\"\nkind = \"didson\"\nbeams = 12\ntilt_deg = 20\nvertical_deg = 20\npings = 3\n{}",
      name, differences);
}

const std::string near_window = "window_start_m = 2\nwindow_length_m = 4\nsamples = 128\nfrequency_khz = 1800\n",
                  far_window = "window_start_m = 4\nwindow_length_m = 6\nsamples = 100\nfrequency_khz = 1100\n";

struct Run {
  Echoes near, far;
  nlohmann::json stats;
};

TEST(SharedHistory, TwoWindowsCostOneSetOfTubesAndGiveWhatEachGivesAlone) {
  const TestFolder folder;
  const std::string near = camera("near", near_window), far = camera("far", far_window);
  const auto run = [&](const std::string& sensors, const std::string& sensor) {
    const Echoes echoes = echoes_in(folder, std::string(scenery) + sensors, {}, sensor);
    return std::pair{echoes, nlohmann::json::parse(bytes_of(folder / "results" / "stats.json"))};
  };
  const auto [near_alone, near_stats] = run(near, "");
  const auto [far_alone, far_stats] = run(far, "");
  const auto [near_together, stats] = run(near + far, "near");
  const Echoes far_together = read_echoes(folder / "results" / "echoes.nc", "far");

  EXPECT_EQ(near_stats["tubes"], 3 * 12 * near_stats["tubes"].get<int>() / (3 * 12));
  EXPECT_EQ(stats["tubes"], near_stats["tubes"]);
  EXPECT_EQ(stats["tubes"], far_stats["tubes"]);
  EXPECT_EQ(stats["footprints"], far_stats["footprints"]) << "the farther window decides what is looked at";
  EXPECT_EQ(stats["pings"], 6);
  std::printf("near %.3e far %.3e  tubes %d\n", largest_relative_difference(near_alone, near_together),
              largest_relative_difference(far_alone, far_together), stats["tubes"].get<int>());
  EXPECT_EQ(far_alone.energy, far_together.energy);
  EXPECT_LT(largest_relative_difference(near_alone, near_together), 1e-12);
  EXPECT_GT(near_alone.total(), 0);
}

TEST(SharedHistory, OtherTubesOrPosesAreTracedAnew) {
  const TestFolder folder;
  const std::string near = camera("near", near_window);
  for (const std::string& difference : {std::string("yaw_deg = 1\n"), std::string("lever_arm_m = [0.1, 0, 0]\n"),
                                        std::string("first_ping_s = 0.05\n"), std::string("horizontal_deg = 28\n")}) {
    SCOPED_TRACE(difference);
    echoes_in(folder, std::string(scenery) + near, {});
    const auto alone = nlohmann::json::parse(bytes_of(folder / "results" / "stats.json"));
    const Echoes own = echoes_in(folder, std::string(scenery) + camera("other", near_window + difference), {});
    const Echoes both = echoes_in(folder, std::string(scenery) + near + camera("other", near_window + difference), {},
                                  "other");
    const auto stats = nlohmann::json::parse(bytes_of(folder / "results" / "stats.json"));
    EXPECT_EQ(stats["tubes"], 2 * alone["tubes"].get<int>());
    EXPECT_EQ(own.energy, both.energy);
  }
}

}  // namespace
}  // namespace tubefoot
