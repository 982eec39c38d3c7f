// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace tubefoot {

/// Throws InputError at a TIFF with a chain of directories that is longer than in any raster, or cyclic.
/// GDAL would follow the chain to its end.
void refuse_long_tiff(const std::filesystem::path& file);

}  // namespace tubefoot
