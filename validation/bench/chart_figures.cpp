// SPDX-License-Identifier: GPL-3.0-or-later
#include "chart_figures.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <filesystem>
#include <utility>
#include <vector>

#include "advice/trials.hpp"
#include "scene/description/scene_description.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "study/chart_page.hpp"

namespace tubefoot {
namespace {

constexpr double reference_tolerance = 1e-7;
constexpr int repeats = 3;

}  // namespace

void chart_figures(const std::function<void(const std::string& name, double value)>& figure) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const std::filesystem::path scenes = TUBEFOOT_SCENES;
  // A number of rays ends the series, so that every machine measures the same settings. Errors beyond it
  // are extrapolated, which gives a separate figure.
  constexpr double all_rays = 70e6, some_rays = 6e6;
  const std::vector<std::pair<const char*, double>> most_rays{
      {"chart/rough-terrain.toml", all_rays}, {"wellhead/scene.toml", all_rays},
      {"chart/flat-bed.toml", some_rays},     {"chart/sphere-on-plane.toml", some_rays},
      {"chart/box-and-wall.toml", some_rays}, {"chart/fractal-terrain.toml", some_rays},
      {"chart/bowl.toml", some_rays},         {"chart/fine-plane.toml", some_rays}};
  for (const auto& [file, rays] : most_rays) {
    TrialScene scene(read_scene_file(scenes / file), first_pings(1), reference_tolerance);
    const std::vector<Trial> trials =
        all_trials(scene, builtin_settings(scene.beams()), repeats, {.rays = rays});
    // By elapsed time, and by the measure that depends least on the load of the machine.
    const WorkMeasure steadiest = steadiest_measure(trials);
    const std::string steadily =
        steadiest == WorkMeasure::instructions ? "_by_instructions" : "_by_processor_time";
    for (const auto& [work, by] : {std::pair{WorkMeasure::seconds, std::string()}, {steadiest, steadily}}) {
      const SceneVerdict verdict = verdict_of(scene.name(), trials, work);
      const auto ratio = [&](const char* name, const std::optional<double>& value, bool extrapolated) {
        if (value)
          figure(fmt::format("{}{}{}_{}", name, by, extrapolated ? "_extrapolated" : "", scene.name()),
                 *value);
      };
      ratio("ray_over_tube_at_0.1dB", verdict.ray_over_tube_at_db, verdict.db_extrapolated);
      ratio("ray_over_tube_at_1e-3", verdict.ray_over_tube_at_l1, verdict.l1_extrapolated);
      figure(fmt::format("crossing_l1{}_{}", by, scene.name()), verdict.crossing_l1);
    }
  }
}

}  // namespace tubefoot
