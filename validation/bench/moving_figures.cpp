// SPDX-License-Identifier: GPL-3.0-or-later
#include "moving_figures.hpp"

#include <tbb/global_control.h>

#include <vector>

#include "run/simulation.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "timing.hpp"

namespace tubefoot {
namespace {

constexpr const char* terrain_and_moving_object = R"(
[[materials]]
name = "sand"

[[terrain]]
kind = "fractal"
width_m = 22
length_m = 22
cell_m = 0.09
rms_height_m = 0.3

[[trajectories]]
name = "camera"
kind = "line"
start_m = [0, -9, 3]
end_m = [0, -8, 3]

[[trajectories]]
name = "fish"
kind = "line"
start_m = [-1, -2, 1.5]
end_m = [1, -2, 1.5]
speed_m_s = 2

[[sensors]]
name = "camera"
kind = "imaging"
trajectory = "camera"
beams = 96
horizontal_deg = 60
vertical_deg = 40
tilt_deg = 22
range_min_m = 1
range_max_m = 20
samples = 512
pings = 30
ping_interval_s = 0.03

[[objects]]
name = "fish"
shape = "sphere"
radius_m = 0.5
chord_error_m = 0.001
)";

}  // namespace

void moving_figures(const std::function<void(const std::string& name, double value)>& figure) {
  const std::string text = terrain_and_moving_object;
  const auto at_rest = open_survey(read_scene_text(text + "position_m = [0, -2, 1.5]\n", "benchmark.toml")),
             moving = open_survey(read_scene_text(text + "trajectory = \"fish\"\n", "benchmark.toml"));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  for (const bool rays : {false, true}) {
    RunRequest request = request_of(moving->scene.description.run);
    if (rays) request.engine = Engine::ray;
    const auto run = [&](const Survey& survey) {
      return seconds([&] {
        PingStore store(layout_of(survey, request));
        simulate(survey, request, store, {});
      });
    };
    run(*at_rest);
    std::vector<double> ratio;
    for (int repetition = 0; repetition < 5; ++repetition) {
      const double rest = run(*at_rest);
      ratio.push_back(run(*moving) / rest);
    }
    figure(rays ? "moving_objects_over_rays" : "moving_objects_over_run", median(ratio));
  }
}

}  // namespace tubefoot
