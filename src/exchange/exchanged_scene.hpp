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

/// The facets of one component that are of one material, in the scene's order, in metres of the local frame,
/// each vertex as the grid has it.
struct ExchangedPiece {
  std::string name;       ///< of the component, and of the material where it has several; unique
  std::string file_stem;  ///< the same in letters, digits, - and _; unique
  std::size_t material = 0;
  std::vector<glm::dvec3> points_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// What other engines can know of a sonar: what it is called, and its limits.
struct ExchangedSonar : SonarOutline {
  std::string name;
  std::vector<double> azimuth_deg;  ///< of the beams, port first, starboard positive, in the fan's plane
  double horizontal_deg = 0;        ///< fan: between its outer borders; turning: of the beam
  double range_min_m = 0, range_max_m = 0;
  int samples = 0;
  double frequency_khz = 0, sound_speed_m_s = 0, absorption_db_per_km = 0;
  Placement carrier;    ///< in our axes
  Placement own;        ///< of the sonar, in our axes
  Placement placement;  ///< of its fan: own, or own turned to look down
};

/// A scene as it leaves for another engine: facets, what they are of, where the sonars are at one ping.
struct ExchangedScene {
  std::string title;
  std::size_t ping = 0;
  std::vector<ExchangedMaterial> materials;
  std::vector<ExchangedPiece> pieces;
  std::vector<ExchangedSonar> sonars;
  double sound_speed_m_s = 1500;
  std::vector<std::string> left_out;  ///< what no format of these can carry, a line each

  std::size_t triangles() const;
  /// Largest coordinate, without its sign: half of its last place as a float is what readers of floats lose.
  double largest_coordinate_m() const;
};

/// Of a sensor (none: all), at its ping of that number. Throws UsageError for a sensor or a ping that is not
/// there.
ExchangedScene exchanged_scene(const Survey& survey, const std::optional<std::string>& sensor,
                               std::size_t ping);

/// A name in letters, digits, - and _, as any file system and any engine takes it; `otherwise` for none.
std::string plain_stem(const std::string& name, const char* otherwise);

/// Half of a float's last place at a coordinate.
double float_rounding_m(double coordinate_m);

}  // namespace tubefoot
