// SPDX-License-Identifier: GPL-3.0-or-later
#include "fresnel_figures.hpp"

#include <tbb/global_control.h>

#include <vector>

#include "run/simulation.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "timing.hpp"

namespace tubefoot {

void fresnel_figures(const std::function<void(const std::string& name, double value)>& figure) {
  SceneDescription description = read_scene_file(TUBEFOOT_SCENES "/wellhead/scene.toml");
  const auto sharp = open_survey(description, Facets::merged);
  for (SensorDescription& sensor : description.sensors) sensor.shadow = "fresnel";
  const auto weighted = open_survey(description, Facets::merged);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto run = [&](const Survey& survey) {
    return seconds([&] {
      const RunRequest request = request_of(survey.scene.description.run);
      PingStore store(layout_of(survey, request));
      simulate(survey, request, store, {});
    });
  };
  run(*sharp);
  std::vector<double> ratio;
  for (int repetition = 0; repetition < 5; ++repetition) {
    const double without = run(*sharp);
    ratio.push_back(run(*weighted) / without);
  }
  figure("fresnel_over_run", median(ratio));
}

}  // namespace tubefoot
