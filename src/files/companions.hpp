// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

namespace tubefoot {

/// Returns the existing files that readers of the format of `file` read in addition to it. These are a
/// raster's world file, projection, mask and metadata, a Shapefile's attributes, and the source rasters of
/// a virtual raster with their companions. The order is fixed. Each file occurs once with its absolute
/// name, and `file` itself does not occur. GDAL can read only these files (GdalInput), and the scene hash
/// covers them.
///
/// The function calls `admit` before it reads each of them. `admit` may throw.
///
/// Throws InputError for files that must not be read: a companion that is not a regular file, or HDF5 with
/// values in other files. The same holds for a GeoPackage that another program is writing, and for a
/// virtual raster that is nested too deeply. The sources of a virtual raster must exist and be rasters.
std::vector<std::filesystem::path> companions_of(
    const std::filesystem::path& file, const std::function<void(const std::filesystem::path&)>& admit = {});

/// Returns the real place of `file`, with links followed, if it is outside of `folder`.
std::optional<std::filesystem::path> place_outside(const std::filesystem::path& folder,
                                                   const std::filesystem::path& file);

}  // namespace tubefoot
