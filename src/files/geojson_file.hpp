// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace tubefoot {

/// GDAL takes time in proportion to the square of the attributes of a GeoJSON, and of the orders in which its
/// features name them: a small file may keep it for minutes. Throws InputError at the line where a file has
/// more than limits::map_attributes names, or more than limits::map_attribute_pairs pairs of names that
/// follow each other.
void refuse_many_attributes(const std::filesystem::path& geojson);

}  // namespace tubefoot
