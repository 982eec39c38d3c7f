// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes whose paths are not straight from a monostatic sonar: refraction, mirrors, two scatterings and a
// separate receiver.
#include <fmt/format.h>

#include <cmath>

#include "suite/scene_text.hpp"

namespace tubefoot {

SuiteScene layered_water_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "A flat bed seen along bent rays";
  scene.solids.push_back(level_plate("bed", "bed", {0, 40, 0}, 80, 80));
  SceneText text;
  text.sonar_m = {0, 0, draw.among(4, 3.5, 4.5, 0.125)};
  text.water = fmt::format(
      "absorption_db_per_km = 0\nprofile = \"gradient\"\nsound_speed_m_s = 1500\ngradient_per_s = "
      "{}\nsurface_height_m = 20\n"
      "profile_bottom_m = 30\n",
      draw.among(-2, -2.5, -1.5, 0.125));
  text.fan = {.beams = 12,
              .horizontal_deg = 12,
              .vertical_deg = 20,
              .tilt_deg = draw.among(8, 7, 9, 0.5),
              .samples = 64,
              .from_m = 16,
              .to_m = 48};
  scene.certified = 3e-2;
  scene.deciders = {{"coarse_l1", 0.05}};
  finish(scene, text);
  return scene;
}

SuiteScene surface_multiple_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "A plate below a sea surface that mirrors: over it there, back, or both";
  SceneText text;
  const double depth = draw.among(2.5, 2.25, 2.75, 0.125), range = draw.among(6.5, 6, 7, 0.125);
  text.sonar_m = {0, 0, -depth};
  // The sonar is level, the plate lies within one beam, and none of its edges is vertical. Bounds are wide
  // where walls of a beam and of its image cut a facet in one line, or meet in its edge.
  constexpr double beam_deg = 1.5, height_m = 0.5;
  text.fan = {.beams = 11,
              .horizontal_deg = 11 * beam_deg,
              .vertical_deg = 88,
              .tilt_deg = 0,
              .samples = 96,
              .from_m = 5,
              .to_m = 11};
  const double azimuth = beam_deg * draw.among(1, -4, 4, 1),
               lower = draw.among(0.15625, 0.09375, 0.28125, 0.0625);
  const glm::dvec3 centre = place_at(text.sonar_m, range, azimuth, 0) - glm::dvec3{0, 0, lower};
  Solid plate = upright_plate("plate", "target", centre, azimuth, 0.109375, height_m);
  plate.vertices_m[1] += glm::dvec3{0.015625, 0.01171875, -0.0107421875};
  plate.vertices_m[3] += glm::dvec3{-0.01953125, 0.0029296875, 0.0087890625};
  scene.solids.push_back(plate);
  text.more = fmt::format("[sea_surface]\nheight_m = 0\nloss_db = {}\n\n[paths]\norder = 3\n",
                          draw.among(1, 0, 3, 0.5));
  // The shortest path over the sea surface leads to the upper edge of the plate, the longest straight path
  // to its lower edge.
  const double upper_depth = depth + lower - height_m / 2;
  const double direct = std::hypot(range, height_m / 2 + lower),
               over = (range + std::hypot(range, depth + upper_depth)) / 2;
  scene.later_from_m = (direct + over) / 2;
  scene.certified = 1e-5;
  scene.deciders = {{"bounces_db", 1}};
  finish(scene, text);
  return scene;
}

SuiteScene two_scatterings_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "Two plates that light each other";
  SceneText text;
  text.sonar_m = {0, 0, 2};
  text.fan = {.beams = 36,
              .horizontal_deg = 36,
              .vertical_deg = 10,
              .tilt_deg = 0,
              .samples = 64,
              .from_m = 5,
              .to_m = 9};
  const double azimuth = draw.among(14, 13, 15, 0.25), range = draw.among(6, 5.75, 6.25, 0.0625),
               turn = draw.among(45, 40, 50, 1);
  constexpr double side_m = 0.375;
  // Each plate is turned away from the sonar, towards the other plate.
  scene.solids.push_back(upright_plate("port", "hard", place_at(text.sonar_m, range, -azimuth, 0),
                                       -azimuth - turn, side_m, side_m));
  scene.solids.push_back(upright_plate("starboard", "hard", place_at(text.sonar_m, range, azimuth, 0),
                                       azimuth + turn, side_m, side_m));
  text.more = "[paths]\norder = 2\nscatterings = 2\npatch_m = 0.09375\n";
  scene.later_from_m = range + 0.75;
  scene.certified.reset();
  scene.tolerance_l1 = 0.01;
  scene.deciders = {{"bounces_db", 1}};
  finish(scene, text);
  return scene;
}

SuiteScene separate_receivers_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "A receiver beside the transmitter";
  SceneText text = over_seabed(draw, scene);
  text.fan.more = fmt::format("receiver_arm_m = [{}, 0, {}]\n", draw.among(2.5, 2, 3, 0.125),
                              draw.among(0.5, 0.25, 0.75, 0.0625));
  scene.solids.push_back(box("box", "target",
                             {draw.among(0.5, -1, 1.5, 0.125), draw.among(-1, -1.5, 0, 0.125), 0.3125},
                             {1.25, 0.75, 0.625}, draw.among(20, 0, 45, 2.5)));
  scene.certified = 1e-3;
  scene.deciders = {{"samples_moved", 1}, {"coarse_l1", 0.08}};
  finish(scene, text);
  return scene;
}

}  // namespace tubefoot
