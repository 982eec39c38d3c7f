// SPDX-License-Identifier: GPL-3.0-or-later
#include "chart_figures.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <filesystem>
#include <utility>
#include <vector>

#include "advice/trials.hpp"
#include "scene/description/scene_description.hpp"
#include "study/chart_page.hpp"

namespace tubefoot {
namespace {

constexpr double reference_tolerance = 1e-7;
constexpr int repeats = 3;

}  // namespace

void chart_figures(const std::function<void(const std::string& name, double value)>& figure) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const std::filesystem::path scenes = TUBEFOOT_SCENES;
  // Where a figure is asked for, rays may take the time that they need to be measured, not extrapolated.
  const std::vector<std::pair<const char*, double>> longest_seconds{
      {"chart/rough-terrain.toml", 6}, {"wellhead/scene.toml", 6},
      {"chart/flat-bed.toml", 1},      {"chart/sphere-on-plane.toml", 1},
      {"chart/box-and-wall.toml", 1},  {"chart/fractal-terrain.toml", 1},
      {"chart/bowl.toml", 1},          {"chart/fine-plane.toml", 1}};
  for (const auto& [file, seconds] : longest_seconds) {
    TrialScene scene(read_scene_file(scenes / file), first_pings(1), reference_tolerance);
    const SceneVerdict verdict =
        verdict_of(scene.name(), all_trials(scene, builtin_settings(scene.beams()), repeats, seconds));
    if (verdict.ray_over_tube_at_db)
      figure(fmt::format("ray_over_tube_at_0.1dB_{}", scene.name()), *verdict.ray_over_tube_at_db);
    if (verdict.ray_over_tube_at_l1)
      figure(fmt::format("ray_over_tube_at_1e-3_{}", scene.name()), *verdict.ray_over_tube_at_l1);
    figure(fmt::format("crossing_l1_{}", scene.name()), verdict.crossing_l1);
  }
}

}  // namespace tubefoot
