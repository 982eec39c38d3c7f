// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "files/input_error.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

/// Micro-texture: octaves of improved Perlin noise.
struct PerlinReflectivityKeys {
  double wavelength_m = 0.5;  ///< longest wavelength
  int octaves = 3;
  double persistence = 0.5;
  double depth = 0.25;
  std::uint64_t seed = 1;
};
/// Micro-texture: a raster, repeated from the origin of the frame, or at its position on Earth.
struct MapReflectivityKeys {
  std::filesystem::path file;
  std::string values = "factor";                ///< factor | db
  std::optional<std::array<double, 2>> tile_m;  ///< east, north
};
struct ReflectivityDescription {
  SourcePlace place;
  std::variant<PerlinReflectivityKeys, MapReflectivityKeys> kind;
};

}  // namespace tubefoot
