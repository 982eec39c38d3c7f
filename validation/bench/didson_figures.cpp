// SPDX-License-Identifier: GPL-3.0-or-later
#include "didson_figures.hpp"

#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "run/simulation.hpp"
#include "sensors/kinds/kind_didson.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

/// Returns the scene with its camera as a DIDSON that moves from the first viewpoint to the second.
SceneDescription sequence(bool side_lobes) {
  SceneDescription scene = read_scene_file(std::filesystem::path(TUBEFOOT_SCENES) / "wellhead/scene.toml");
  std::erase_if(scene.sensors, [](const SensorDescription& sensor) { return sensor.name != "camera"; });
  SensorDescription& camera = scene.sensors.front();
  camera.first_ping_s = 0;
  camera.pings = 16;
  camera.ping_interval_s = 0.4;
  auto& didson = camera.kind.edit<DidsonDescription>();
  didson.beam_centres = "lens";
  didson.cycles = 8;
  if (!side_lobes) return scene;
  didson.receive_margin_deg = 1;
  for (PatternDescription* pattern : {&camera.transmit, &camera.receive}) {
    pattern->pattern = "line";
    pattern->aperture_m = 0.1015;
  }
  return scene;
}

}  // namespace

void didson_figures(const std::function<void(const std::string&, double)>& figure) {
  constexpr int repeats = 3;
  const tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
  for (const bool side_lobes : {true, false}) {
    const auto survey = open_survey(sequence(side_lobes));
    double best_s = 1e300;
    for (int repeat = 0; repeat < repeats; ++repeat) {
      SimulationStats stats;
      const auto start = std::chrono::steady_clock::now();
      simulate(*survey, request_of(survey->scene.description.run), stats);
      best_s =
          std::min(best_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    figure(side_lobes ? "didson_frames_per_s" : "didson_frames_per_s_ideal",
           static_cast<double>(survey->sensors.front().times_s.size()) / best_s);
  }
}

}  // namespace tubefoot
