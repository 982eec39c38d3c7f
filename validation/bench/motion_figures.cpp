// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion_figures.hpp"

#include <tbb/global_control.h>

#include <memory>
#include <stdexcept>
#include <vector>

#include "run/simulation.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "timing.hpp"

namespace tubefoot {
namespace {

constexpr const char* terrain_and_fast_boat = R"(
[water]
sound_speed_m_s = 1500
absorption_db_per_km = 60

[[materials]]
name = "sand"

[[terrain]]
kind = "fractal"
width_m = 100
length_m = 100
cell_m = 0.5
rms_height_m = 0.5

[trajectory]
kind = "line"
start_m = [0, -20, 20]
end_m = [0, 20, 20]
speed_m_s = 20

[[sensors]]
name = "swath"
kind = "multibeam"
beams = 128
swath_deg = 128
beam_across_deg = 1
along_track_deg = 1
range_min_m = 10
range_max_m = 60
samples = 800
pings = 4
ping_interval_s = 0.4
)";

/// The survey whose records have this number of intervals.
std::unique_ptr<const Survey> with_intervals(std::size_t intervals) {
  SceneDescription description = read_scene_text(terrain_and_fast_boat, "benchmark.toml");
  SensorDescription& sensor = description.sensors.front();
  sensor.stop_and_hop = false;
  // The number of intervals is inversely proportional to the step.
  sensor.motion_step_beams = 10;
  std::unique_ptr<const Survey> survey = open_survey(description);
  for (double step = 10; survey->sensors[0].sensor->transmissions() < intervals; step *= 0.97) {
    sensor.motion_step_beams = step;
    survey = open_survey(description);
  }
  if (survey->sensors[0].sensor->transmissions() != intervals)
    throw std::runtime_error("no step of the motion gives the wanted number of intervals");
  return survey;
}

}  // namespace

void motion_figures(const std::function<void(const std::string& name, double value)>& figure) {
  const auto plain = open_survey(read_scene_text(terrain_and_fast_boat, "benchmark.toml"));
  const auto few = with_intervals(4), many = with_intervals(16);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto run = [&](const Survey& survey) {
    return seconds([&] {
      const RunRequest request = request_of(survey.scene.description.run);
      PingStore store(layout_of(survey, request));
      simulate(survey, request, store, {});
    });
  };
  run(*plain);
  std::vector<double> interval_ratio, linear;
  for (int repetition = 0; repetition < 7; ++repetition) {
    const double without = run(*plain), by_few = run(*few), by_many = run(*many);
    interval_ratio.push_back((by_many - by_few) / 12 / without);
    linear.push_back(by_many / by_few / 4);
  }
  figure("motion_interval_over_run", median(interval_ratio));
  figure("motion_linear", median(linear));
}

}  // namespace tubefoot
