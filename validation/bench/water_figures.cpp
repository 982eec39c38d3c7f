// SPDX-License-Identifier: GPL-3.0-or-later
#include "water_figures.hpp"

#include <tbb/global_control.h>

#include <filesystem>
#include <fstream>
#include <string>
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

constexpr const char* patterns = "receive_pattern = \"line\"\nreceive_aperture_m = 0.1\n";

}  // namespace

void water_figures(const std::function<void(const std::string& name, double value)>& figure) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const std::filesystem::path layers = std::filesystem::temp_directory_path() / "tubefoot-bench-layers.csv";
  std::ofstream(layers) << "depth_m,volume_scattering_db\n-4,-80\n-1.5,-70\n-1,-57\n-0.5,-60\n";
  const auto compare = [&](const std::string& name, const std::string& scene, const std::string& key) {
    const auto silent = open_survey(read_scene_text(scene, "benchmark.toml")),
               scattering = open_survey(read_scene_text(scene + "[water]\n" + key, "benchmark.toml"));
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
  const std::string text = terrain_and_camera, uniform = "volume_scattering_db = -60\n";
  compare("volume_over_run", text, uniform);
  compare("volume_layers_over_run", text, "volume_scattering_file = \"" + layers.string() + "\"\n");
  compare("volume_patterns_over_run", text + patterns, uniform);
  std::filesystem::remove(layers);
}

}  // namespace tubefoot
