// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of range, absorption and grazing angle, and of a seabed so large that rounding errors show.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "suite/scene_text.hpp"

namespace tubefoot {
namespace {

/// Upright plates perpendicular to the direction from the sonar. Each covers some of the beams at a range
/// of its own.
SuiteScene plates(Draw& draw, const std::string& title, double absorption_db_per_km) {
  SuiteScene scene;
  scene.title = title;
  SceneText text;
  text.sonar_m = {draw.among(0, -2, 2, 0.125), draw.among(0, -2, 2, 0.125), draw.among(2, 1, 3, 0.125)};
  text.water = fmt::format("sound_speed_m_s = 1500\nabsorption_db_per_km = {}\n", absorption_db_per_km);
  text.fan = {.beams = 36,
              .horizontal_deg = 36,
              .vertical_deg = 8,
              .tilt_deg = 0,
              .samples = 144,
              .from_m = 2.5,
              .to_m = 11.5};
  constexpr std::array<double, 5> nearest{3, 4.125, 5.5, 7.375, 10};
  constexpr double between_deg = 7.2, half_width_deg = 2.625;
  const double half_height_deg = text.fan.vertical_deg / 2 + 1;
  int k = 0;
  for (const std::size_t which : draw.order({2, 0, 4, 1, 3})) {
    const double range = nearest[which] + draw.among(0, 0, 0.75, 0.0625), azimuth = between_deg * (k - 2);
    const auto half = [&](double angle_deg) { return range * std::tan(angle_deg * std::numbers::pi / 180); };
    scene.solids.push_back(upright_plate(fmt::format("plate-{}", k++), "target",
                                         place_at(text.sonar_m, range, azimuth, 0), azimuth,
                                         2 * half(half_width_deg), 2 * half(half_height_deg)));
  }
  finish(scene, text);
  return scene;
}

}  // namespace

SuiteScene range_law_scene(Draw& draw) {
  SuiteScene scene = plates(draw, "Plates square to the sonar, at five ranges", 0);
  scene.deciders = {{"gain_db", 0.25}, {"range_exponent", 0.05}};
  return scene;
}

SuiteScene absorption_scene(Draw& draw) {
  SuiteScene scene = plates(draw, "The same in absorbing water", draw.among(400, 250, 600, 25));
  scene.deciders = {{"db_per_km", 10}};
  return scene;
}

SuiteScene grazing_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "A flat bed at grazing angles";
  scene.solids.push_back(level_plate("bed", "bed", {0, 16, 0}, 40, 40));
  SceneText text;
  text.sonar_m = {draw.among(0, -2, 2, 0.125), draw.among(0, -1, 1, 0.125),
                  draw.among(0.625, 0.5, 0.875, 0.0625)};
  text.fan = {.vertical_deg = 24, .tilt_deg = 0, .samples = 128, .from_m = 4, .to_m = 20};
  scene.deciders = {{"range_exponent", 0.05}, {"coarse_l1", 0.05}};
  finish(scene, text);
  return scene;
}

SuiteScene large_flat_scene(Draw& draw) {
  SuiteScene scene;
  scene.title = "A bed of two triangles and 16 square kilometres, far from the origin";
  scene.solids.push_back(level_plate("bed", "bed", {0, 0, 0}, 4000, 4000));
  SceneText text;
  text.sonar_m = {draw.among(1503.25, 1400, 1600, 0.125), draw.among(-1221.5, -1300, -1100, 0.125),
                  draw.among(2.5, 2.25, 2.75, 0.0625)};
  text.fan = {.vertical_deg = 90, .tilt_deg = 0};
  scene.deciders = {{"coarse_l1", 0.05}};
  finish(scene, text);
  return scene;
}

}  // namespace tubefoot
