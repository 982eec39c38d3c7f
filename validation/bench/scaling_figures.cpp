// SPDX-License-Identifier: GPL-3.0-or-later
#include "scaling_figures.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>

#include "run/simulation.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

constexpr const char* scene_text = R"(
[water]
sound_speed_m_s = 1500
[[materials]]
name = "bed"
lambert_db = -25
[[terrain]]
name = "seen"
kind = "fractal"
width_m = 24
length_m = 24
centre_m = [0, 14, 0]
cell_m = 0.2
rms_height_m = 0.3
hurst = 0.7
seed = 5
[trajectory]
kind = "fixed"
position_m = [0, 0, 5]
[[sensors]]
name = "sonar"
kind = "imaging"
tilt_deg = 29
horizontal_deg = 40
vertical_deg = 24
beams = {}
samples = 512
range_min_m = 1
range_max_m = 25
pings = 3
{})";

constexpr const char* wall_text = R"(
[[objects]]
name = "wall"
shape = "box"
size_m = [40, 0.2, 40]
position_m = [0, 8, 0]
)";

/// A million facets behind the wall. They are rough, because the facets of a plane would be merged.
constexpr const char* hidden_text = R"(
[[terrain]]
name = "unseen"
kind = "fractal"
rms_height_m = 0.05
hurst = 0.7
seed = 6
width_m = 12
length_m = 12
centre_m = [0, 15, 0]
cell_m = 0.01697
)";

struct PingSeconds {
  double visibility = std::numeric_limits<double>::infinity(), whole = visibility;
};

PingSeconds least_seconds(int beams, const std::string& more) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "tubefoot-bench-scaling.toml";
  std::ofstream(file) << fmt::format(fmt::runtime(scene_text), beams, more);
  const auto survey = open_survey(read_scene_file(file));
  std::filesystem::remove(file);
  PingSeconds least;
  constexpr int repeats = 5;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    SimulationStats stats;
    simulate(*survey, request_of(survey->scene.description.run), stats);
    least.visibility = std::min(least.visibility, stats.visibility_seconds);
    least.whole = std::min(least.whole, stats.visibility_seconds + stats.echo_seconds);
  }
  return least;
}

}  // namespace

void scaling_figures(const std::function<void(const std::string&, double)>& figure) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const PingSeconds single = least_seconds(1, ""), many = least_seconds(1024, "");
  figure("beams_1024_over_1", many.visibility / single.visibility);
  figure("beams_1024_over_1_ping", many.whole / single.whole);
  const PingSeconds none = least_seconds(64, wall_text),
                    million = least_seconds(64, std::string(wall_text) + hidden_text);
  figure("hidden_million_over_none", million.visibility / none.visibility);
}

}  // namespace tubefoot
