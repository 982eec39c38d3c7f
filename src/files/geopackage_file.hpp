// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace tubefoot {

/// Throws InputError at a GeoPackage that contains more than tables. Views are programs, and virtual tables
/// may refer to other files; only the indexes that every GeoPackage has are allowed.
/// A GeoPackage that another program is still writing is an error as well, because its last changes are in
/// a separate file.
void refuse_geopackage_surprises(const std::filesystem::path& file);

}  // namespace tubefoot
