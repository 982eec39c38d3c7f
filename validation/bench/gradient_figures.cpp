// SPDX-License-Identifier: GPL-3.0-or-later
#include "gradient_figures.hpp"

#include <tbb/global_control.h>

#include <vector>

#include "geometry/tubes/tube.hpp"
#include "run/simulation.hpp"
#include "run/weighted_gradient.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "timing.hpp"

namespace tubefoot {
namespace {

constexpr const char* terrain_and_camera = R"(
[water]
sound_speed_m_s = 1500
absorption_db_per_km = 100

[[materials]]
name = "sand"

[[terrain]]
kind = "fractal"
width_m = 22
length_m = 22
cell_m = 0.2
rms_height_m = 0.3

[trajectory]
kind = "fixed"
position_m = [0, -9, 3]

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
)";

}  // namespace

void gradient_figures(const std::function<void(const std::string& name, double value)>& figure) {
  const auto survey = open_survey(read_scene_text(terrain_and_camera, "benchmark.toml"));
  const RunRequest plain = request_of(survey->scene.description.run);
  RunRequest forward = plain;
  forward.gradient = {"camera.position.east", "camera.position.north", "camera.position.up",
                      "camera.rotation.x",    "camera.rotation.y",     "camera.rotation.z"};
  const std::vector<double> weights(std::size_t(96) * 512, 1.0);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto run = [&](const RunRequest& request) {
    return seconds([&] {
      PingStore store(layout_of(*survey, request));
      simulate(*survey, request, store, {});
    });
  };
  run(plain);
  std::vector<double> forward_ratio, reverse_ratio;
  for (int repetition = 0; repetition < 9; ++repetition) {
    const double without = run(plain);
    forward_ratio.push_back(run(forward) / without);
    reverse_ratio.push_back(seconds([&] { weighted_gradient(*survey, plain, {weights}); }) / without);
  }
  figure("gradient_forward_over_run", median(forward_ratio));
  figure("gradient_reverse_over_run", median(reverse_ratio));
}

}  // namespace tubefoot
