// SPDX-License-Identifier: GPL-3.0-or-later
#include "water_figures.hpp"

#include <tbb/global_control.h>

#include <vector>

#include "run/simulation.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "timing.hpp"

namespace tubefoot {
namespace {

constexpr const char* terrain_and_camera = R"(
[[materials]]
name = "sand"

[[terrain]]
kind = "fractal"
width_m = 22
length_m = 22
cell_m = 0.09
rms_height_m = 0.3

[trajectory]
kind = "line"
start_m = [0, -9, 3]
end_m = [0, -8, 3]

[[sensors]]
name = "camera"
kind = "imaging"
beams = 96
horizontal_deg = 60
vertical_deg = 40
tilt_deg = 22
range_min_m = 1
range_max_m = 20
samples = 512
pings = 10
ping_interval_s = 0.03
)";

constexpr const char* patterns = R"(
[sensors.receive]
pattern = "line"
aperture_m = 0.1
)";

}  // namespace

void water_figures(const std::function<void(const std::string& name, double value)>& figure) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const std::string text = terrain_and_camera, water = "[water]\n";
  const auto compare = [&](const std::string& name, const std::string& scene, const VolumeScattering* layers) {
    const auto silent = open_survey(read_scene_text(scene, "benchmark.toml"));
    SceneDescription description = read_scene_text(scene + water + "volume_scattering_db = -60\n", "benchmark.toml");
    const auto scattering = open_survey(description);
    if (layers != nullptr) const_cast<Scene&>(scattering->scene).volume = *layers;
    const RunRequest request = request_of(silent->scene.description.run);
    const auto run = [&](const Survey& survey) {
      return seconds([&] {
        PingStore store(layout_of(survey, request));
        simulate(survey, request, store, {});
      });
    };
    run(*silent);
    std::vector<double> ratio;
    for (int repetition = 0; repetition < 5; ++repetition) {
      const double rest = run(*silent);
      ratio.push_back(run(*scattering) / rest);
    }
    figure(name, median(ratio));
  };
  const VolumeScattering layers{{0.5, 1, 1.5}, {1e-6, 2e-6, 1e-7, 1e-8}};
  compare("volume_over_run", text, nullptr);
  compare("volume_layers_over_run", text, &layers);
  compare("volume_patterns_over_run", text + patterns, nullptr);
}

}  // namespace tubefoot
