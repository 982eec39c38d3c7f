// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gdal_priv.h>

#include <optional>
#include <string>

namespace tubefoot {

/// What to say of a band of a raster that is stored in blocks (strips, tiles, chunks) larger than
/// limits::block_bytes, and what to do about it; nothing for others. GDAL holds at least one block whole,
/// however little of it is read and however few bytes it has in the file.
std::optional<std::string> too_large_block(GDALRasterBand& band);

}  // namespace tubefoot
