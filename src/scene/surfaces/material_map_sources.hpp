// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <string>

#include "scene/surfaces/material_map.hpp"

namespace tubefoot {

/// Data for all sources of a material map.
struct MaterialMapSetting {
  const std::vector<MaterialDescription>& materials;
  std::uint16_t default_material;
  glm::dvec3 lo_m, hi_m;  ///< extent of the terrain in the local frame
  const LocalFrame& frame;
  SourcePlace place;  ///< place of the map in the scene file
};

/// Reads the classes of a raster: one region per material, with borders along the edges of cells. Throws
/// InputError with the raster's name. One error lists the classes without a material.
MaterialMap raster_material_map(const RasterMaterialMap& map, const MaterialMapSetting& setting);
/// Reads polygons: one region each, in the order of the file or in reverse. Throws InputError with the
/// file's name.
MaterialMap polygon_material_map(const PolygonMaterialMap& map, const MaterialMapSetting& setting);
/// Creates patches that depend only on position and seed. Throws InputError at the map's place.
MaterialMap patch_material_map(const PatchMaterialMap& map, const MaterialMapSetting& setting);

/// Returns the index of a material by its name. Throws InputError at `place`, with `who` before the
/// message.
std::uint16_t material_named(const std::string& name, const std::vector<MaterialDescription>& materials,
                             const SourcePlace& place, const std::string& who);
/// Throws InputError for more than most_material_borders.
void check_border_count(std::size_t borders, const SourcePlace& place);

}  // namespace tubefoot
