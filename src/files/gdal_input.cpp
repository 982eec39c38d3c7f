// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/gdal_input.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <vector>

#include "files/companions.hpp"
#include "files/raster_block.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> with_companions(const fs::path& file) {
  std::vector<fs::path> files = companions_of(file);
  files.push_back(file);
  return files;
}

/// "GeoTIFF, BAG or VRT"
std::string list_of(std::initializer_list<FileFormat> formats) {
  std::vector<std::string_view> names;
  for (const FileFormat format : formats)
    if (std::ranges::find(names, name_of(format)) == names.end()) names.push_back(name_of(format));
  const std::string_view last = names.back();
  names.pop_back();
  return names.empty() ? std::string(last) : fmt::format("{} or {}", fmt::join(names, ", "), last);
}

GDALDatasetUniquePtr opened(const fs::path& file, FileFormat format) {
  const std::array<const char*, 2> drivers{gdal_driver_of(format), nullptr};
  // SQLite looks for changes beside the file unless it is told that nobody makes any.
  const std::array<const char*, 2> unlocked{"NOLOCK=YES", nullptr};
  // By an absolute name: others may be taken for addresses or for parts of files.
  return GDALDatasetUniquePtr(
      GDALDataset::Open(fs::absolute(file).lexically_normal().c_str(),
                        GDAL_OF_RASTER | GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR,
                        drivers.data(), format == FileFormat::geopackage ? unlocked.data() : nullptr));
}

}  // namespace

GdalInput::GdalInput(const fs::path& file, std::initializer_list<FileFormat> expected)
    : place_{file.string(), 0, 0}, door_(with_companions(file)) {
  const FileFormat format = format_of(file);
  if (std::ranges::find(expected, format) == expected.end())
    fail(fmt::format("cannot be read as {}: it is {} (gdal_translate and ogr2ogr convert many)",
                     list_of(expected),
                     format == FileFormat::other ? "empty, cut off or of another format"
                                                 : fmt::format("a {}", name_of(format))));
  dataset_ = opened(file, format);
  if (dataset_ == nullptr)
    fail(fmt::format("cannot be read as {}: it is cut off or corrupt", name_of(format)));
  if (const auto problem = too_large_block(*dataset_)) fail(*problem);
  if (format != FileFormat::vrt) return;
  // A virtual raster's own blocks say nothing of those that its sources are stored in.
  for (const fs::path& part : companions_of(file)) {
    const FileFormat of_part = format_of(part);
    if (of_part == FileFormat::vrt || of_part == FileFormat::other) continue;
    const GDALDatasetUniquePtr source = opened(part, of_part);
    if (source == nullptr)
      fail(fmt::format("is a virtual raster of '{}', which cannot be read as {}", part.string(),
                       name_of(of_part)));
    if (const auto problem = too_large_block(*source))
      fail(fmt::format("is a virtual raster of '{}', which {}", part.string(), *problem));
  }
}

void GdalInput::read_row(GDALRasterBand& band, int row, int column, int columns, GDALDataType type,
                         void* out) const {
  if (band.RasterIO(GF_Read, column, row, columns, 1, out, columns, 1, type, 0, 0, nullptr) == CE_None)
    return;
  // GDAL's last word names the file, which may be one of many in a virtual raster.
  const auto& told = messages_.failures();
  fail(fmt::format("row {} cannot be read: the file is cut off or corrupt{}", row,
                   told.size() > 1 ? ": " + told.back() : ""));
}

void GdalInput::fail(const std::string& message) const {
  throw InputError(place_, message + messages_.in_brackets());
}

}  // namespace tubefoot
