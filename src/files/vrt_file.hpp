// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

namespace tubefoot {

/// Returns the source files of a GDAL virtual raster (VRT), in the order of the file and with repetitions.
/// The names are absolute. The files need not exist.
///
/// Throws InputError at the VRT, with the line, for elements and attributes that are not on a short list.
/// The list permits plain or scaled parts of other rasters, masks, georeference and descriptions. It
/// excludes warped, derived or raw bands, open options, overviews, geolocation, and addresses of networks
/// or archives. GDAL then opens only the returned files.
std::vector<std::filesystem::path> vrt_sources(const std::filesystem::path& vrt);

}  // namespace tubefoot
