// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that sensors with the same tubes at the same positions share one history, so that the tubes are
// computed once.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "fixtures/world/echoes.hpp"

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
chord_error_m = 0.01
radius_m = 0.5
position_m = [0, 4, 0.3]
[trajectory]
kind = "line"
start_m = [0, -1, 2]
end_m = [0, 1, 2]
)";

std::string camera(const std::string& name, const std::string& differences) {
  return fmt::format(
      "[[sensors]]\nname = \"{}\"\nkind = \"didson\"\nbeams = 6\nhorizontal_deg = 6\ntilt_deg = "
      "20\nvertical_deg = 20\npings = 2\n{}",
      name, differences);
}

const std::string near_window =
                      "window_start_m = 2\nwindow_length_m = 4\nsamples = 128\nfrequency_khz = 1800\n",
                  far_window =
                      "window_start_m = 4\nwindow_length_m = 6\nsamples = 100\nfrequency_khz = 1100\n";

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

  EXPECT_EQ(near_stats["tubes"], 2 * 6);
  EXPECT_EQ(stats["tubes"], near_stats["tubes"]);
  EXPECT_EQ(stats["tubes"], far_stats["tubes"]);
  EXPECT_EQ(stats["footprints"], far_stats["footprints"]) << "the farther window decides what is looked at";
  EXPECT_EQ(stats["pings"], 4);
  EXPECT_EQ(far_alone.energy, far_together.energy);
  EXPECT_EQ(near_alone.energy, near_together.energy);
  EXPECT_GT(near_alone.total(), 0);
}

TEST(SharedHistory, OtherTubesOrPosesAreTracedAnew) {
  const TestFolder folder;
  const std::string near = camera("near", near_window);
  for (const char* difference : {"lever_arm_m = [0.1, 0, 0]\n", "first_ping_s = 0.05\n", "roll_deg = 1\n"}) {
    SCOPED_TRACE(difference);
    const Echoes own =
        echoes_in(folder, std::string(scenery) + camera("other", near_window + difference), {});
    const Echoes both = echoes_in(
        folder, std::string(scenery) + near + camera("other", near_window + difference), {}, "other");
    const auto stats = nlohmann::json::parse(bytes_of(folder / "results" / "stats.json"));
    EXPECT_EQ(stats["tubes"], 2 * 2 * 6);
    EXPECT_EQ(own.energy, both.energy);
  }
}

// The cycles of one frame: if the camera has not moved in between, the second cycle uses the visible
// polygons of the first.
TEST(SharedHistory, CyclesThatFireFromOnePlaceAreWhatEachIsAlone) {
  const TestFolder folder;
  const auto frame = [&](double first_s, double interval_s) {
    const std::string lobes =
        "receive_margin_deg = 1\ntransmit_pattern = \"line\"\ntransmit_aperture_m = 0.1\n"
        "receive_pattern = \"line\"\nreceive_aperture_m = 0.1\ncycles = 2\n";
    std::string text = camera("frame", near_window + lobes);
    text.replace(text.find("pings = 2"), 9, "pings = 1");
    return echoes_in(folder,
                     std::string(scenery) + text +
                         fmt::format("first_ping_s = {}\ncycle_interval_s = {}\n", first_s, interval_s));
  };
  const Echoes moving = frame(0.5, 0.25), before = frame(0.5, 0), after = frame(0.75, 0);
  ASSERT_EQ(moving.beams, 6u);
  EXPECT_GT(moving.total(), 0);
  EXPECT_NE(before.energy, after.energy);
  for (std::size_t beam = 0; beam < moving.beams; ++beam)
    for (std::size_t k = 0; k < moving.samples; ++k)
      ASSERT_EQ(moving.at(0, beam, k), (beam % 2 == 0 ? before : after).at(0, beam, k)) << beam << ' ' << k;
}

}  // namespace
}  // namespace tubefoot
