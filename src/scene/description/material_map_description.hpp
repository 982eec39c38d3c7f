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

// What a scene file says: scene/description/scene_description.hpp.
namespace tubefoot {

/// What a material map calls a material, and what the scene calls it.
struct MaterialClass {
  std::string value, material;
  SourcePlace place;
};
struct RasterMaterialMap {
  std::filesystem::path file;
  std::vector<MaterialClass> classes;             ///< values are whole numbers
  std::optional<std::array<double, 2>> origin_m;  ///< east, north of the raster's south-west corner
  std::optional<double> cell_m;                   ///< goes with origin_m
};
struct PolygonMaterialMap {
  std::filesystem::path file;
  std::optional<std::string> layer;
  std::string attribute = "material";
  std::vector<MaterialClass> classes;  ///< empty: the attribute names the materials themselves
  std::string overlaps = "last";       ///< last | first: which of two polygons counts
  std::string coordinates = "crs";     ///< crs | local: local metres, whatever CRS the file states
};
struct MaterialShare {
  std::string material;
  double share = 0;
  SourcePlace place;
};
/// Seeded patches: the cells of the Voronoi diagram of one point in each square of a lattice.
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
