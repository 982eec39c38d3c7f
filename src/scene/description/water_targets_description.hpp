// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "files/input_error.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

/// Target strength: a constant, or a table over direction that `tubefoot strength` writes.
struct TargetStrengthDescription {
  std::optional<double> target_strength_db;  ///< dB re 1 m^2
  std::optional<std::filesystem::path> file;
  SourcePlace file_place;
};

/// A single target in the water.
struct WaterTargetDescription {
  SourcePlace place;
  std::string name;
  std::array<double, 3> position_m{0, 0, 0};
  std::optional<std::array<double, 2>> position_lat_lon_deg;  ///< instead of x and y of position_m
  TargetStrengthDescription strength;
  double heading_deg = 0, pitch_deg = 0, roll_deg = 0;  ///< of the axes of the table
};

/// Targets at random positions that depend only on the seed and on the place.
struct TargetPopulationDescription {
  SourcePlace place;
  std::string name;
  double density_per_m3 = 0;
  std::optional<double> top_depth_m, bottom_depth_m;   ///< below the height of the sea surface
  std::array<double, 2> centre_m{0, 0}, size_m{0, 0};  ///< east-west and north-south extent
  TargetStrengthDescription strength;
  double strength_spread_db = 0;  ///< standard deviation of the target strength
  std::uint64_t seed = 1;
};

}  // namespace tubefoot
