// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <string>

#include "scene/surfaces/material_map.hpp"

namespace tubefoot {

/// What every source of a material map is reported.
struct MaterialMapSetting {
  const std::vector<MaterialDescription>& materials;
  std::uint16_t default_material;
  glm::dvec3 lo_m, hi_m;  ///< extent of the terrain in the local frame
  const LocalFrame& frame;
  SourcePlace place;  ///< of the map in the scene file
};

/// Classes of a raster: a region a material, borders along the edges of cells. Throws InputError with the
/// raster's name; one that lists the classes that have no material.
MaterialMap raster_material_map(const RasterMaterialMap& map, const MaterialMapSetting& setting);
/// Polygons: a region each, in the order of the file or against it. Throws InputError with the file's name.
MaterialMap polygon_material_map(const PolygonMaterialMap& map, const MaterialMapSetting& setting);
/// Patches that depend on the place and the seed alone. Throws InputError at the map's place.
MaterialMap patch_material_map(const PatchMaterialMap& map, const MaterialMapSetting& setting);

/// Index of a material by its name; throws InputError at `place`, with `who` in front.
std::uint16_t material_named(const std::string& name, const std::vector<MaterialDescription>& materials,
                             const SourcePlace& place, const std::string& who);
/// Throws InputError for more than most_material_borders.
void check_border_count(std::size_t borders, const SourcePlace& place);

}  // namespace tubefoot
