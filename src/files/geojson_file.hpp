// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace tubefoot {

/// Throws InputError for a GeoJSON with too many attributes, at the line that exceeds a limit. The limits
/// are limits::map_attributes names and limits::map_attribute_pairs pairs of consecutive names.
/// GDAL's time grows with the square of the number of attributes, and of the number of orders in which
/// features name them. A small file could therefore take minutes.
void refuse_many_attributes(const std::filesystem::path& geojson);

}  // namespace tubefoot
