// SPDX-License-Identifier: GPL-3.0-or-later
// tubefoot_track_study SCENE TRACK FRAMES: estimates the track of a camera from consecutive frames. It runs
// the first camera of a scene twice, over its micro-texture and over a uniform seabed with speckle. Writes
// a diagram of the measured and the true track, and a sheet of frames that shows the motion of the texture.
#include <fmt/format.h>

#include <exception>
#include <filesystem>

#include "files/utc.hpp"
#include "run/simulation.hpp"
#include "sensors/kinds/scene_file.hpp"
#include "sensors/products/received.hpp"
#include "study/diagram.hpp"
#include "study/svg_png.hpp"
#include "track/drift_sheet.hpp"

namespace tubefoot {
namespace {

constexpr double pixel_m = 0.01;
constexpr int most_shift = 12;

/// `sheet`: file for the drawing of the frames; empty: none.
TrackEstimate track_of(const SceneDescription& description, const std::filesystem::path& sheet = {}) {
  const auto survey = open_survey(description);
  SimulationStats stats;
  const Recording camera = simulate(*survey, request_of(description.run), stats, {false}).front();
  const RunContext run{survey->scene.frame, *unix_time_s(description.run.start_utc), description.run.seed,
                       description.water, description.title};
  std::vector<std::vector<double>> frames;
  const ReceivedPings received(camera, run);
  for (std::size_t ping = 0; ping < camera.pings(); ++ping) frames.push_back(received.of(ping));
  if (!sheet.empty())
    draw_drift(camera, frames, 0, label_font()).write_png(sheet, "drift of a texture over camera frames");
  return estimate_track(camera, frames, {0, pixel_m}, most_shift);
}

PlotSeries line_of(const std::string& name, const std::vector<TrackStep>& steps, bool joined) {
  PlotSeries series{name, "", {{0, 0}}, joined};
  for (const TrackStep& step : steps)
    series.points.emplace_back(series.points.back().first + step.starboard_m,
                               series.points.back().second + step.ahead_m);
  return series;
}

int run(const std::filesystem::path& scene, const std::filesystem::path& picture,
        const std::filesystem::path& sheet) {
  SceneDescription textured = read_scene_file(scene), even = textured;
  textured.sensors.resize(1);
  even.sensors.resize(1);
  for (MaterialDescription& material : even.materials) material.reflectivity.clear();
  even.sensors.front().signal.speckle = "rayleigh";
  const TrackEstimate with = track_of(textured, sheet), without = track_of(even);
  for (const auto& [name, track] :
       {std::pair{"micro-texture, no speckle", &with}, {"no texture, speckle", &without}})
    fmt::print(
        "{}: {} steps, worst error {:.3f} pixels of {} m; correlation of adjacent frames {:.3f} to {:.3f}\n",
        name, track->shifts.size(), track->worst_pixels, pixel_m, track->least_correlation,
        track->largest_correlation);

  Diagram diagram;
  diagram.title = "Track of a camera, estimated from consecutive frames";
  diagram.x_label = "starboard (m)";
  diagram.y_label = "ahead (m)";
  diagram.scale = Scale::linear;
  diagram.series = {line_of("true", with.true_steps, true),
                    line_of("reflectivity texture", with.measured, false),
                    line_of("speckle only", without.measured, true)};
  write_png_of_svg(to_svg(diagram), picture);
  return 0;
}

}  // namespace
}  // namespace tubefoot

int main(int argc, char** argv) {
  if (argc != 4) {
    fmt::print(stderr, "usage: tubefoot_track_study SCENE TRACK FRAMES\n");
    return 2;
  }
  try {
    return tubefoot::run(argv[1], argv[2], argv[3]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
