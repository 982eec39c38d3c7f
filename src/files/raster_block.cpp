// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/raster_block.hpp"

#include <fmt/format.h>

#include "files/limits.hpp"

namespace tubefoot {

std::optional<std::string> too_large_block(GDALRasterBand& band) {
  int columns = 0, rows = 0;
  band.GetBlockSize(&columns, &rows);
  const std::int64_t bytes = std::int64_t{columns} * GDALGetDataTypeSizeBytes(band.GetRasterDataType());
  if (rows <= 0 || bytes <= limits::block_bytes / rows) return std::nullopt;
  return fmt::format(
      "is stored in blocks of {} x {} cells, which are more than {} MB each: rewrite it with gdal_translate "
      "-co "
      "TILED=YES",
      columns, rows, limits::block_bytes >> 20);
}

}  // namespace tubefoot
