// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

namespace tubefoot {

/// The files that a GDAL virtual raster (VRT) is put together from, also through virtual rasters among them,
/// in the order in which they are named, each once; nothing for any other file, told by its content, as GDAL
/// does. They need not exist. Throws InputError at the VRT for one that is no XML, that is nested too deeply,
/// or that reads through GDAL's virtual file systems (networks, archives): what it gives could not be
/// hashed.
std::vector<std::filesystem::path> vrt_sources(const std::filesystem::path& file);

}  // namespace tubefoot
