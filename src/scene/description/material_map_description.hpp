// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "files/input_error.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

/// A material's name in a material map and in the scene.
struct MaterialClass {
  std::string value, material;
  SourcePlace place;
};
struct RasterMaterialMap {
  std::filesystem::path file;
  std::vector<MaterialClass> classes;             ///< values are whole numbers
  std::optional<std::array<double, 2>> origin_m;  ///< east, north of the raster's south-west corner
  std::optional<double> cell_m;                   ///< required with origin_m
};
struct PolygonMaterialMap {
  std::filesystem::path file;
  std::optional<std::string> layer;
  std::string attribute = "material";
  std::vector<MaterialClass> classes;  ///< if empty, the attribute contains the names of materials
  std::string overlaps = "last";       ///< last | first: the polygon that counts where two overlap
  std::string coordinates = "crs";     ///< crs | local: local metres for any CRS of the file
};
struct MaterialShare {
  std::string material;
  double share = 0;
  SourcePlace place;
};
/// Seeded patches: the Voronoi cells of one point in each square of a lattice.
struct PatchMaterialMap {
  double patch_size_m = 0;
  std::vector<MaterialShare> shares;
  std::uint64_t seed = 1;
};
struct MaterialMapDescription {
  SourcePlace place;
  std::variant<RasterMaterialMap, PolygonMaterialMap, PatchMaterialMap> kind;
};

}  // namespace tubefoot
