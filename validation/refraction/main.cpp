// SPDX-License-Identifier: GPL-3.0-or-later
// tubefoot_refraction_study SCENE PICTURE: shows the seabed that the first multibeam of a scene with a
// sound-speed profile measures. Soundings are reduced with the sound speed at the sonar along straight
// rays. It compares the water of the scene, one gradient of the same depth and opposite sign, and
// isovelocity water. Writes a diagram across the track.
#include <fmt/format.h>

#include <cmath>
#include <exception>
#include <filesystem>

#include "files/utc.hpp"
#include "run/simulation.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "sensors/products/swath_soundings.hpp"
#include "study/diagram.hpp"
#include "study/svg_png.hpp"

namespace tubefoot {
namespace {

PlotSeries soundings_in(const std::string& name, SceneDescription description) {
  description.sensors.resize(1);
  description.sensors.front().pings = 1;
  const auto survey = open_survey(description);
  SimulationStats stats;
  const Recording recording = simulate(*survey, request_of(description.run), stats).front();
  const RunContext run{survey->scene.frame, *unix_time_s(description.run.start_utc), description.run.seed,
                       description.water, description.title};
  PlotSeries series{name, "", {}, true};
  for (const auto& sounding : BottomFinder(recording, run, {}).sound(0).soundings)
    if (sounding) series.points.emplace_back(sounding->position_m.x, sounding->position_m.z);
  fmt::print("{}: {} soundings at {:.2f} m/s, {} apparent facets\n", name, series.points.size(),
             recording.sound_speed_m_s, stats.refraction.facets);
  return series;
}

int run(const std::filesystem::path& scene, const std::filesystem::path& picture) {
  const SceneDescription layered = read_scene_file(scene);
  SceneDescription even = layered, opposite = layered;
  even.water.profile = "constant";
  even.water.profile_file.reset();
  opposite.water.profile = "gradient";
  opposite.water.profile_file.reset();
  opposite.water.sound_speed_m_s = 1480;
  opposite.water.gradient_per_s = 1.5;
  opposite.water.profile_bottom_m = 25;
  Diagram diagram;
  diagram.title = "Soundings of a flat seabed, computed with straight rays";
  diagram.x_label = "east (m)";
  diagram.y_label = "up (m)";
  diagram.scale = Scale::linear;
  diagram.series = {soundings_in("isovelocity water", even),
                    soundings_in("thermocline of the scene", layered),
                    soundings_in("sound speed rises with depth", opposite)};
  write_png_of_svg(to_svg(diagram), picture);
  return 0;
}

}  // namespace
}  // namespace tubefoot

int main(int argc, char** argv) {
  if (argc != 3) {
    fmt::print(stderr, "usage: tubefoot_refraction_study SCENE PICTURE\n");
    return 2;
  }
  try {
    return tubefoot::run(argv[1], argv[2]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
