// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace tubefoot {

/// Throws InputError at a GeoPackage that is more than tables: with views, which are programs, or virtual
/// tables other than the indexes that every GeoPackage has, which may be other files; or one that another
/// program has not finished writing to, whose last changes stand in a file beside it.
void refuse_geopackage_surprises(const std::filesystem::path& file);

}  // namespace tubefoot
