// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "suite/suite_scene.hpp"

namespace tubefoot {

/// The sonar of the pack: a fan of ideal beams whose central direction is north.
struct SuiteFan {
  int beams = 32;
  double horizontal_deg = 32, vertical_deg = 20, tilt_deg = 20;
  std::string spacing = "angle";
  std::vector<double>
      angles_deg{};  ///< angles of the beam axes, instead of `beams`, `horizontal_deg` and `spacing`
  int samples = 128;
  double from_m = 4, to_m = 12;
  std::string more{};  ///< further lines of the sensor's section
  double frequency_khz = 700;
};

/// Parameters of the scene files of the pack. Sections have the syntax of a scene file.
struct SceneText {
  std::string water = "sound_speed_m_s = 1500\nabsorption_db_per_km = 0\n";
  glm::dvec3 sonar_m{0, -8, 3};
  std::string trajectory{};   ///< instead of a fixed position
  std::string object_path{};  ///< trajectory named "path" of the moving objects
  SuiteFan fan;
  std::string sensor{};  ///< section of the sensor, instead of `fan`
  std::string more{};    ///< further sections
};

/// Rounds the vertices of the solids with snap(), and writes the scene file without its first line to
/// `scene.text`.
void finish(SuiteScene& scene, const SceneText& text);

/// Returns the point at a range, azimuth and elevation from the sonar.
glm::dvec3 place_at(glm::dvec3 sonar_m, double range_m, double azimuth_deg, double elevation_deg);

/// Returns the description of a sonar over a level seabed of 32 m at z = 0, with drawn values.
SceneText over_seabed(Draw& draw, SuiteScene& scene);

}  // namespace tubefoot
