// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/relief/elevation_field.hpp"
#include "scene/description/relief_description.hpp"
#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// A measured map of heights over the facets (GeoTIFF, BAG, ESRI ASCII grid, netCDF; band 1, with its scale,
/// offset and unit), the spline through the centres of its cells. Cells without data have height 0, and so
/// has what lies beyond a map that is not repeated. A map whose lattice does not lie along the frame's axes
/// is resampled, bilinearly, onto one that does. GDAL's warnings are added to `warnings`.
///
/// Throws InputError with the file's name: what GDAL cannot read, a map of fewer than 2 x 2 or more than
/// 50 million cells, and of maps that are not repeated those without a geotransform, with a CRS where the
/// frame has none, or without one where it has.
std::shared_ptr<const ElevationField> read_relief_map(const MapReliefDescription& map,
                                                      const LocalFrame& frame,
                                                      std::vector<std::string>& warnings);

}  // namespace tubefoot
