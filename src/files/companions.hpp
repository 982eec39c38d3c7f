// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

namespace tubefoot {

/// The files that are read along with `file` by those who read its format, and that are there: a raster's
/// world file, projection, mask and metadata, a Shapefile's attributes, the rasters that a virtual raster is
/// put together from with theirs. Always in the same order, each once, under absolute names; `file` itself is
/// not among them. GDAL sees these and no others (GdalInput), and the scene hash covers them.
///
/// `admit` is asked before each of them is looked into, and may throw.
///
/// Throws InputError for what must not be read: a companion that is no ordinary file, a virtual raster whose
/// sources are not there or no rasters or that is nested too deeply, HDF5 with values in other files, a
/// GeoPackage that is being written to.
std::vector<std::filesystem::path> companions_of(
    const std::filesystem::path& file, const std::function<void(const std::filesystem::path&)>& admit = {});

/// Where `file` really is, links followed, if that is not in `folder` or below it.
std::optional<std::filesystem::path> place_outside(const std::filesystem::path& folder,
                                                   const std::filesystem::path& file);

}  // namespace tubefoot
