// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes with equiangular beams, equidistant beams and listed beam angles, and scenes with side lobes.
#include <fmt/format.h>

#include "suite/scene_text.hpp"

namespace tubefoot {
namespace {

/// Upright plates about two beams wide across the fan, with empty beams between them.
SuiteScene posts(Draw& draw, const std::string& title, const SuiteFan& fan, double half_fan_deg) {
  constexpr int count = 13;
  SuiteScene scene;
  scene.title = title;
  SceneText text;
  text.fan = fan;
  text.sonar_m = {draw.among(0, -2, 2, 0.125), draw.among(0, -2, 2, 0.125), 2};
  const double between_deg = 2 * half_fan_deg / count;
  for (int k = 0; k < count; ++k) {
    const double azimuth =
        between_deg * (k - (count - 1) / 2.0) + draw.among(k % 2 == 0 ? 0.25 : -0.25, -0.75, 0.75, 0.125);
    const double range = draw.among(k % 3 + 5, 5, 8, 0.0625);
    scene.solids.push_back(upright_plate(fmt::format("post-{}", k), "target",
                                         place_at(text.sonar_m, range, azimuth, 0), azimuth, range / 24, 2));
  }
  scene.deciders = {{"beams_off", 0.1}};
  finish(scene, text);
  return scene;
}

SuiteFan wide_fan() {
  return {.beams = 64,
          .horizontal_deg = 80,
          .vertical_deg = 8,
          .tilt_deg = 0,
          .samples = 80,
          .from_m = 4,
          .to_m = 9};
}

}  // namespace

SuiteScene equiangular_scene(Draw& draw) {
  return posts(draw, "Posts before beams that are even in angle", wide_fan(), 38);
}

SuiteScene equidistant_scene(Draw& draw) {
  SuiteFan fan = wide_fan();
  fan.spacing = "distance";
  return posts(draw, "Posts before beams that are even in tangent", fan, 38);
}

SuiteScene listed_angles_scene(Draw& draw) {
  SuiteFan fan = wide_fan();
  constexpr int steps = 63,
                alike = 9;  // number of neighbouring beams with equal spacing; the listed angles drift from
                            // equiangular ones
  std::vector<double> step_deg;
  for (int k = 0; k < steps / alike; ++k) step_deg.push_back(draw.among(0.75 + 0.125 * k, 0.75, 1.5, 0.125));
  double all = 0;
  for (const double step : step_deg) all += alike * step;
  double angle = -all / 2;
  fan.angles_deg = {angle};
  for (int k = 0; k < steps; ++k) fan.angles_deg.push_back(angle += step_deg[k / alike]);
  return posts(draw, "Posts before beams of a list of angles", fan, all / 2 - 1);
}

SuiteScene side_lobes_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "One small target, heard by the side lobes of all beams";
  SceneText text;
  text.sonar_m = {0, 0, 2};
  text.fan = {.vertical_deg = 8, .tilt_deg = 0, .samples = 64, .from_m = 4, .to_m = 8};
  text.fan.more = fmt::format("receive_pattern = \"line\"\nreceive_aperture_m = {}\n",
                              draw.among(0.0625, 0.0546875, 0.0703125, 0.0078125));
  const double azimuth = draw.among(-3.5, -6, 6, 0.25), range = draw.among(6, 5, 7, 0.0625);
  scene.solids.push_back(
      box("target", "target", place_at(text.sonar_m, range, azimuth, 0), {0.0625, 0.0625, 0.25}, azimuth));
  scene.main_lobe_beams = 3;
  scene.deciders = {{"side_lobes_db", 1}};
  scene.certified = 1e-6;
  finish(scene, text);
  return scene;
}

}  // namespace tubefoot
