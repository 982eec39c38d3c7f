// SPDX-License-Identifier: GPL-3.0-or-later
#include "chart_figures.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <filesystem>
#include <map>
#include <vector>

#include "app/trials.hpp"
#include "scene/scene_description.hpp"
#include "study/chart_page.hpp"

namespace tubefoot {
namespace {

constexpr double reference_tolerance = 1e-7;
/// The rungs of a ladder are about 4 apart; one that would take longer than this is extrapolated to.
constexpr double next_rung = 5, longest_seconds = 2;
constexpr int repeats = 3;

std::vector<Trial> trials_of(TrialScene& scene) {
  std::vector<Trial> trials;
  std::vector<EngineSetting> settings = tube_settings();
  for (EngineSetting& s : ray_settings(scene.beams())) settings.push_back(std::move(s));
  std::map<std::string, double> last_seconds;
  for (const EngineSetting& setting : settings) {
    double& last = last_seconds[setting.engine];
    if (setting.rays > 0 && next_rung * last > longest_seconds) {
      last = longest_seconds;  // nor any finer one
      continue;
    }
    trials.push_back(scene.run(setting, last > 0.1 ? 1 : repeats));
    last = trials.back().seconds;
  }
  return trials;
}

}  // namespace

void chart_figures(const std::function<void(const std::string& name, double value)>& figure) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const std::filesystem::path scenes = TUBEFOOT_SCENES;
  for (const char* file : {"chart/rough-terrain.toml", "wellhead/scene.toml", "chart/flat-bed.toml",
                           "chart/sphere-on-plane.toml", "chart/box-and-wall.toml",
                           "chart/fractal-terrain.toml", "chart/bowl.toml", "chart/fine-plane.toml"}) {
    TrialScene scene(read_scene_file(scenes / file), first_pings(1), reference_tolerance);
    const SceneVerdict verdict = verdict_of(scene.name(), trials_of(scene));
    if (verdict.ray_over_tube_at_db)
      figure(fmt::format("ray_over_tube_at_0.1dB_{}", scene.name()), *verdict.ray_over_tube_at_db);
    if (verdict.ray_over_tube_at_l1)
      figure(fmt::format("ray_over_tube_at_1e-3_{}", scene.name()), *verdict.ray_over_tube_at_l1);
    figure(fmt::format("crossing_l1_{}", scene.name()), verdict.crossing_l1);
  }
}

}  // namespace tubefoot
