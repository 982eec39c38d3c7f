// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of scattering water, of derivatives of energies, and of diffraction at the border of a shadow.
#include <fmt/format.h>

#include "suite/scene_text.hpp"

namespace tubefoot {

SuiteScene volume_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "Scattering water, and a plate behind which it returns nothing";
  SceneText text;
  text.sonar_m = {0, 0, 2};
  text.water = fmt::format("sound_speed_m_s = 1500\nabsorption_db_per_km = {}\nvolume_scattering_db = {}\n",
                           draw.among(0, 0, 200, 25), draw.among(-20, -24, -18, 0.5));
  text.fan = {.beams = 24,
              .horizontal_deg = 24,
              .vertical_deg = 10,
              .tilt_deg = 0,
              .samples = 64,
              .from_m = 4,
              .to_m = 8};
  const double azimuth = draw.among(-2.5, -4, 4, 0.5), range = draw.among(5.5, 5.25, 5.75, 0.0625);
  scene.solids.push_back(
      upright_plate("plate", "target", place_at(text.sonar_m, range, azimuth, 0), azimuth, 1, 3));
  scene.water_to_m = range - 0.25;
  scene.deciders = {{"volume_db", 0.25}, {"lit_in_shadow", 0.01}};
  finish(scene, text);
  return scene;
}

SuiteScene derivatives_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "Derivatives of the echoes of a box over the bed, and of its shadow";
  SceneText text = over_seabed(draw, scene);
  text.water = "sound_speed_m_s = 1500\nabsorption_db_per_km = 100\n";
  scene.solids.push_back(box("box", "target",
                             {draw.among(0.25, -0.5, 0.5, 0.125), draw.among(-0.75, -1, -0.5, 0.125),
                              draw.among(0.5, 0.5, 0.75, 0.0625)},
                             {1.25, 0.75, 0.625}, draw.among(20, 10, 40, 2.5)));
  scene.gradient = {"sonar.position.up", "box.position.north", "box.rotation.z", "material.bed.mu",
                    "water.absorption"};
  scene.deciders = {{"gradient_l1", 0.1}, {"coarse_l1", 0.08}};
  finish(scene, text);
  return scene;
}

SuiteScene shadow_border_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "A wall, and diffraction into its shadow on the bed";
  SceneText text = over_seabed(draw, scene);
  text.fan.frequency_khz = draw.among(40, 30, 50, 2.5);
  text.fan.more = "shadow = \"fresnel\"\n";
  scene.solids.push_back(box("wall", "target",
                             {draw.among(0.25, -0.5, 0.5, 0.125), draw.among(-1.5, -1.75, -1.25, 0.125), 0.5},
                             {1.5, 0.125, 1}, draw.among(-10, -15, 15, 2.5)));
  scene.certified.reset();
  scene.tolerance_l1 = 0.01;
  scene.has_sharp_answer = true;
  scene.deciders = {{"border_db", 1}, {"coarse_l1", 0.08}};
  finish(scene, text);
  return scene;
}

}  // namespace tubefoot
