// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

namespace tubefoot {

/// The files that a GDAL virtual raster (VRT) is put together from, in the order in which they are named,
/// each as often as it is. Their names are absolute. They need not exist.
///
/// Throws InputError at the VRT, with the line, for whatever is not on a short list of elements and
/// attributes: pieces of other rasters, plain or scaled, masks, georeference and descriptions. So nothing
/// that GDAL could be told there makes it open a file that is not on this list: no warped, derived or raw
/// bands, open options, overviews, geolocation, addresses of networks or archives.
std::vector<std::filesystem::path> vrt_sources(const std::filesystem::path& vrt);

}  // namespace tubefoot
