// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/relief/elevation_field.hpp"
#include "scene/description/relief_description.hpp"
#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// Reads a measured map of heights over the facets (GeoTIFF, BAG, ESRI ASCII grid, netCDF; band 1, with its
/// scale, offset and unit). The result is the spline through the centres of its cells. Cells without data
/// have height 0, as has the area outside of a map that is not repeated. A map whose lattice is not aligned
/// with the frame's axes is resampled bilinearly. GDAL's warnings are added to `warnings`.
///
/// Throws InputError with the file's name if GDAL cannot read the map. The map must have at least 2 x 2 and
/// at most 50 million cells. A map that is not repeated needs a geotransform. It must have a CRS if and
/// only if the frame has one.
std::shared_ptr<const ElevationField> read_relief_map(const MapReliefDescription& map,
                                                      const LocalFrame& frame,
                                                      std::vector<std::string>& warnings);

}  // namespace tubefoot
