// SPDX-License-Identifier: GPL-3.0-or-later
#include "suite/scene_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace tubefoot {
namespace {

// Strengths of Lambert's law, in dB.
constexpr std::array<std::pair<std::string_view, int>, 4> materials{
    {{"bed", -20}, {"target", -10}, {"middling", -15}, {"hard", -6}}};

std::string sensor_text(const SuiteFan& fan) {
  std::string beams = fan.angles_deg.empty()
                          ? fmt::format("beams = {}\nhorizontal_deg = {}\n", fan.beams, fan.horizontal_deg)
                          : fmt::format("beam_angles_deg = [{}]\n", fmt::join(fan.angles_deg, ", "));
  if (fan.spacing != "angle") beams += fmt::format("spacing = \"{}\"\n", fan.spacing);
  return fmt::format(
      "[[sensors]]\nname = \"sonar\"\nkind = \"imaging\"\nfrequency_khz = {}\n{}vertical_deg = {}\n"
      "tilt_deg = {}\nsamples = {}\nrange_min_m = {}\nrange_max_m = {}\n{}",
      fan.frequency_khz, beams, fan.vertical_deg, fan.tilt_deg, fan.samples, fan.from_m, fan.to_m, fan.more);
}

}  // namespace

void finish(SuiteScene& scene, const SceneText& text) {
  std::string& out = scene.text;
  out = fmt::format("title = \"{}\"\n\n[water]\n{}\n", scene.title, text.water);
  for (const auto& [name, db] : materials)
    if (std::ranges::any_of(scene.solids, [&](const Solid& solid) { return solid.material == name; }))
      out += fmt::format("[[materials]]\nname = \"{}\"\nlambert_db = {}\n\n", name, db);
  for (Solid& solid : scene.solids) {
    snap(solid);
    out += fmt::format(
        "[[objects]]\nname = \"{0}\"\nshape = \"mesh\"\nmaterial = \"{1}\"\nfile = \"{0}.obj\"\n{2}\n",
        solid.name, solid.material, solid.more);
  }
  const glm::dvec3& at = text.sonar_m;
  // A scene with two trajectories names them.
  const bool one = text.object_path.empty();
  out += one ? "[trajectory]\n" : "[[trajectories]]\nname = \"sonar\"\n";
  out += text.trajectory.empty()
             ? fmt::format("kind = \"fixed\"\nposition_m = [{}, {}, {}]\n", at.x, at.y, at.z)
             : text.trajectory;
  if (!one) out += "\n[[trajectories]]\nname = \"path\"\n" + text.object_path;
  out += "\n" + (text.sensor.empty() ? sensor_text(text.fan) : text.sensor);
  if (!text.more.empty()) out += "\n" + text.more;
}

glm::dvec3 place_at(glm::dvec3 sonar_m, double range_m, double azimuth_deg, double elevation_deg) {
  constexpr double radian = std::numbers::pi / 180;
  const double a = azimuth_deg * radian, e = elevation_deg * radian;
  return sonar_m + range_m * glm::dvec3{std::sin(a) * std::cos(e), std::cos(a) * std::cos(e), std::sin(e)};
}

SceneText over_seabed(Draw& draw, SuiteScene& scene) {
  scene.solids.push_back(level_plate("bed", "bed", {0, 0, 0}, 32, 32));
  SceneText text;
  text.sonar_m = {draw.among(0, -1, 1, 0.125), draw.among(-8, -8.5, -7.5, 0.125),
                  draw.among(3, 2.75, 3.25, 0.0625)};
  text.fan.tilt_deg = draw.among(20, 18, 22, 0.5);
  text.fan.horizontal_deg = draw.among(32, 28, 36, 1);
  text.fan.from_m = draw.among(4, 3.75, 4.25, 0.125);
  text.fan.to_m = draw.among(12, 11.5, 12.5, 0.125);
  return text;
}

}  // namespace tubefoot
