// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "exchange/frames.hpp"
#include "sensors/recordings/sonar_outline.hpp"

namespace tubefoot {

struct Survey;

struct ExchangedMaterial {
  std::string name;
  double lambert_db = 0;
};

/// Facets of one component with one material, in the order of the scene, in metres of the local frame.
/// Vertices are those of the grid.
struct ExchangedPiece {
  std::string name;       ///< name of the component, and of the material if it has several; unique
  std::string file_stem;  ///< the same name in letters, digits, - and _; unique
  std::size_t material = 0;
  std::vector<glm::dvec3> points_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Properties of a sonar that other engines can represent: its name and its limits.
struct ExchangedSonar : SonarOutline {
  std::string name;
  /// Azimuths of the beams in the plane of the fan, port first, starboard positive.
  std::vector<double> azimuth_deg;
  double horizontal_deg = 0;  ///< fan: angle between its outer borders; turning: width of the beam
  double range_min_m = 0, range_max_m = 0;
  int samples = 0;
  double frequency_khz = 0, sound_speed_m_s = 0, absorption_db_per_km = 0;
  Placement carrier;    ///< in the axes of tubefoot
  Placement own;        ///< pose of the sonar, in the axes of tubefoot
  Placement placement;  ///< pose of its fan: `own`, or `own` turned to look down
};

/// A scene for export: facets, their materials, and the sonars at one ping. Moving objects are at the time of
/// this ping of the first sonar.
struct ExchangedScene {
  std::string title;
  std::size_t ping = 0;
  std::vector<ExchangedMaterial> materials;
  std::vector<ExchangedPiece> pieces;
  std::vector<ExchangedSonar> sonars;
  double sound_speed_m_s = 1500;
  std::vector<std::string> left_out;  ///< properties that none of the formats can represent, one line each

  std::size_t triangles() const;
  /// Largest absolute coordinate. Readers that use floats lose half of its last place as a float.
  double largest_coordinate_m() const;
};

/// Returns the scene with one sensor (none: all) at the ping with this number. Throws UsageError for a
/// missing sensor or ping.
ExchangedScene exchanged_scene(const Survey& survey, const std::optional<std::string>& sensor,
                               std::size_t ping);

/// Returns a name in letters, digits, - and _, which every file system and engine accepts; `otherwise` for
/// an empty name.
std::string plain_stem(const std::string& name, const char* otherwise);

/// Returns half of the last place of a float at a coordinate.
double float_rounding_m(double coordinate_m);

}  // namespace tubefoot
