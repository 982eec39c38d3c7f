// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "scene/description/scene_component.hpp"
#include "scene/description/scene_description.hpp"
#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// Reads a raster of heights (GeoTIFF, BAG, ESRI ASCII grid, netCDF; band 1) as facets: a vertex at the
/// centre of every cell that has data, a triangle between neighbouring centres where all three have it. Cells
/// without data, NaN or masked, are holes. The band's scale, offset and unit are applied.
///
/// `frame` is the scene's local frame. Unset (the scene has no [georeference], and no raster before this one
/// settled it), the raster sets it and says so in a warning: about the window's centre along the axes of the
/// raster's own CRS if that is projected, tangent there if it is geographic, local metres as they stand if it
/// has none.
///
/// Throws InputError with the raster's file name, and GDAL's message: a file that GDAL cannot read whole, a
/// raster that is rotated, has no geotransform, no data in the window, or no CRS in a georeferenced scene.
ComponentMesh read_raster(const RasterTerrain& terrain, std::optional<LocalFrame>& frame);

}  // namespace tubefoot
