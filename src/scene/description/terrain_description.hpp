// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "files/input_error.hpp"
#include "scene/description/material_map_description.hpp"
#include "scene/description/scene_component.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

struct FlatTerrain {
  double width_m = 0, length_m = 0;  ///< east-west and north-south extent, centred on `centre_m`
  std::array<double, 3> centre_m{0, 0, 0};
  double cell_m = 0;                            ///< 0: two facets in total
  double slope_deg = 0, slope_heading_deg = 0;  ///< falls towards the heading, about the centre
};

/// Seeded fractal relief: a fractional Brownian surface as a sum of octaves of gradient noise. The same
/// seed gives the same seabed.
struct FractalTerrain {
  double width_m = 0, length_m = 0;
  std::array<double, 3> centre_m{0, 0, 0};
  double cell_m = 1;
  double slope_deg = 0, slope_heading_deg = 0;  ///< as in FlatTerrain
  double rms_height_m = 0.1;
  double hurst = 0.8;               ///< between 0 and 1
  double largest_wavelength_m = 0;  ///< 0: the larger extent
  std::uint64_t seed = 1;
  double ripple_height_m = 0;  ///< crest to trough of sinusoidal sand ripples; 0: no ripples
  double ripple_wavelength_m = 0.2;
  double ripple_direction_deg = 0;  ///< compass direction of the wave vector (across the crests)
};

struct RasterTerrain {
  std::filesystem::path file;                ///< path resolved against the scene file's folder
  std::optional<std::array<int, 4>> window;  ///< column, row, columns, rows (from the north-west corner)
  int decimate = 1;                          ///< keep every n-th row and column
  double resolution_m = 0;                   ///< for a BAG of variable resolution; 0: every node
  bool depth_positive_down = false;          ///< values are depths instead of heights
  std::string load = "auto";                 ///< auto | whole | tiles (docs/large-jobs.md)
};

struct TerrainDescription {
  SourcePlace place;
  std::string name = "terrain";
  std::string material;
  SourcePlace material_place;
  std::optional<MaterialMapDescription> material_map;  ///< `material` applies where the map has no material
  std::variant<FlatTerrain, FractalTerrain, RasterTerrain> kind;
  std::shared_ptr<const ComponentMesh> facets;  ///< given in memory instead of `kind`; otherwise null
};

}  // namespace tubefoot
