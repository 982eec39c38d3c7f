// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "scene/description/scene_component.hpp"
#include "scene/description/terrain_description.hpp"
#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// Reads a raster of heights (GeoTIFF, BAG, ESRI ASCII grid, netCDF; band 1) as facets. Every cell with
/// data has a vertex at its centre. Triangles join neighbouring centres if all three have data. Cells
/// without data (NaN or masked) are holes. The scale, offset and unit of the band are applied.
///
/// `frame` is the scene's local frame. It is empty if the scene has no [georeference] and no earlier raster
/// determined it. The raster then sets the frame about the window's centre and states this in a warning. A
/// projected CRS gives a frame along its axes, a geographic CRS a tangent frame, and a raster without CRS
/// local metres.
///
/// Throws InputError with the raster's file name and GDAL's message. Errors are a file that GDAL cannot
/// read completely, a rotated raster, no geotransform, and no data in the window. In a georeferenced scene,
/// a raster without CRS is an error, too.
ComponentMesh read_raster(const RasterTerrain& terrain, std::optional<LocalFrame>& frame);

}  // namespace tubefoot
