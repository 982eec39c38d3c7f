// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of visibility: shadows, thin walls, silhouettes, occlusion order, many small objects, terrain, and
// pings of a moving sonar.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "suite/scene_text.hpp"

namespace tubefoot {

SuiteScene near_plane_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "A box nearer than the first sample, and its shadow on the bed";
  const SceneText text = over_seabed(draw, scene);
  const double azimuth = draw.among(3, -8, 8, 0.5), side = draw.among(0.3125, 0.25, 0.375, 0.03125);
  scene.solids.push_back(
      box("near-box", "target",
          place_at(text.sonar_m, draw.among(2, 1.75, 2.25, 0.125), azimuth, -text.fan.tilt_deg),
          {side, side, side}, azimuth));
  scene.deciders = {{"lit_in_shadow", 0.01}};
  finish(scene, text);
  return scene;
}

SuiteScene thin_wall_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "A wall four millimetres thick";
  const SceneText text = over_seabed(draw, scene);
  constexpr double thick_m = 4.0 / 1024, height_m = 0.75;
  scene.solids.push_back(box(
      "wall", "target", {draw.among(0.25, -0.5, 0.5, 0.125), draw.among(-0.5, -1, 0, 0.125), height_m / 2},
      {2, thick_m, height_m}, draw.among(-25, -35, 35, 2.5)));
  scene.deciders = {{"lit_in_shadow", 0.01}, {"coarse_l1", 0.08}};
  finish(scene, text);
  return scene;
}

SuiteScene silhouettes_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "A sphere over the bed: round edges of what is seen and of what is in shadow";
  const SceneText text = over_seabed(draw, scene);
  const double radius = draw.among(0.75, 0.5, 0.875, 0.0625);
  scene.solids.push_back(sphere("sphere", "target",
                                {draw.among(0.25, -1, 1, 0.125), draw.among(-0.5, -1, 0.5, 0.125),
                                 radius + draw.among(0.25, 0, 0.5, 0.0625)},
                                radius, 32, 64));
  scene.deciders = {{"edges_off", 0.05}};
  finish(scene, text);
  return scene;
}

SuiteScene occlusion_order_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "Plates that hide one another, two of them crossing, named in any order";
  SceneText text;
  text.sonar_m = {0, 0, 2};
  text.fan = {.vertical_deg = 12, .tilt_deg = 0, .from_m = 4, .to_m = 8};
  const double shift = draw.among(0, -1.5, 1.5, 0.25);
  const auto plate = [&](const std::string& name, const std::string& material, double range, double azimuth,
                         double turn, double width, double height) {
    return upright_plate(name, material, place_at(text.sonar_m, range, azimuth + shift, 0),
                         azimuth + shift + turn, width, height);
  };
  const std::array plates{plate("front", "bed", draw.among(4.5, 4.25, 4.75, 0.0625), -6, 0, 0.75, 0.5),
                          plate("middle", "target", draw.among(5.5, 5.25, 5.75, 0.0625), 0, 0, 1.25, 0.75),
                          plate("crossing", "middling", draw.among(5.625, 5.5, 5.75, 0.0625), 5,
                                draw.among(40, 30, 55, 2.5), 1.25, 0.625),
                          plate("back", "hard", draw.among(7.25, 7, 7.5, 0.0625), 0, 0, 3.75, 2)};
  for (const std::size_t k : draw.order({3, 0, 2, 1})) scene.solids.push_back(plates.at(k));
  scene.deciders = {{"samples_moved", 1}, {"lit_in_shadow", 0.01}};
  finish(scene, text);
  return scene;
}

SuiteScene many_small_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "Eight hundred stones smaller than a beam";
  const SceneText text = over_seabed(draw, scene);
  Solid stones{"stones", "target", {}, {}};
  const auto between = [&](double least, double most) { return least + (most - least) * draw.number(); };
  for (int k = 0; k < 800; ++k) {
    const glm::dvec3 size{between(0.02, 0.08), between(0.02, 0.08), between(0.02, 0.08)};
    add(stones, box("stone", "target", {between(-4, 4), between(-3, 4.5), size.z / 2}, size, between(0, 90)));
  }
  scene.solids.push_back(stones);
  scene.deciders = {{"coarse_l1", 0.08}};
  finish(scene, text);
  return scene;
}

SuiteScene terrain_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "Rough terrain at grazing angles";
  Solid seabed{"terrain", "bed", {}, {}};
  constexpr std::uint32_t columns = 64, rows = 80;
  constexpr double cell_m = 0.125, south_m = 2;
  const double p = draw.among(0, 0, 6, 0.25), q = draw.among(1, 0, 6, 0.25), r = draw.among(0, 0, 6, 0.25);
  const double rough = draw.among(0.03, 0.02, 0.05, 0.005);
  for (std::uint32_t j = 0; j <= rows; ++j)
    for (std::uint32_t i = 0; i <= columns; ++i) {
      const double x = (i - columns / 2.0) * cell_m, y = south_m + j * cell_m;
      seabed.vertices_m.emplace_back(
          x, y,
          0.15 * std::sin(1.3 * x + 0.9 * y + p) + 0.12 * std::cos(1.9 * y - 0.7 * x + q) +
              0.1 * std::sin(0.5 * x - 2.7 * y + r) + rough * (2 * draw.number() - 1));
    }
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::uint32_t a = j * (columns + 1) + i;
      seabed.facets.push_back({a, a + 1, a + columns + 2});
      seabed.facets.push_back({a, a + columns + 2, a + columns + 1});
    }
  scene.solids.push_back(seabed);
  SceneText text;
  text.sonar_m = {0, 0, draw.among(2, 1.75, 2.25, 0.0625)};
  text.fan.tilt_deg = draw.among(14, 12, 16, 0.5);
  text.fan.vertical_deg = 24;
  scene.deciders = {{"coarse_l1", 0.1}};
  finish(scene, text);
  return scene;
}

SuiteScene moving_sonar_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "Six pings on the way past a box";
  SceneText text = over_seabed(draw, scene);
  scene.solids.push_back(box("box", "target",
                             {draw.among(0.5, -1, 1, 0.125), draw.among(-0.5, -1, 0, 0.125), 0.3125},
                             {1.25, 0.75, 0.625}, draw.among(20, 0, 45, 2.5)));
  const glm::dvec3& at = text.sonar_m;
  text.trajectory =
      fmt::format("kind = \"line\"\nstart_m = [{}, {}, {}]\nend_m = [{}, {}, {}]\nspeed_m_s = {}\n", at.x,
                  at.y - 1, at.z, at.x + draw.among(0.5, -0.5, 0.5, 0.125), at.y + 3,
                  at.z - draw.among(0.25, 0, 0.25, 0.0625), draw.among(2, 1.5, 2.5, 0.125));
  text.fan.more = "pings = 6\nping_interval_s = 0.25\n";
  scene.deciders = {{"pings_off", 0}, {"coarse_l1", 0.08}};
  finish(scene, text);
  return scene;
}

}  // namespace tubefoot
