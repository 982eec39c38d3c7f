// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tubefoot {

/// Files beside `file` that a reader takes in with it and that are there: a Shapefile's attributes, a
/// raster's world file, projection, mask and metadata, the rasters that a virtual raster is put together
/// from, a GeoPackage's write-ahead log. Always in the same order. Throws InputError as vrt_sources() does.
std::vector<std::filesystem::path> companions_of(const std::filesystem::path& file);

/// A place beside `file` that a reader would open unasked (its companions', and others that GDAL tries) and
/// that is no ordinary file, like a pipe: opening it may wait for ever.
std::optional<std::filesystem::path> special_companion(const std::filesystem::path& file);

/// Where `file` really is, links followed, if that is not in `folder` or below it.
std::optional<std::filesystem::path> place_outside(const std::filesystem::path& folder,
                                                   const std::filesystem::path& file);

/// For each name in a scene file of a file that is, or has a companion that is, place_outside() its folder:
/// the name's place and where the file is. That is allowed, but a scene that comes from somebody else should
/// not do it unseen. Throws InputError as read_scene_file() does.
std::vector<std::string> names_that_leave_the_folder(const std::filesystem::path& scene_file);

}  // namespace tubefoot
