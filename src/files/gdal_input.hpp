// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gdal_priv.h>

#include <filesystem>
#include <initializer_list>
#include <string>

#include "files/file_format.hpp"
#include "files/gdal_door.hpp"
#include "files/gdal_messages.hpp"
#include "files/input_error.hpp"

namespace tubefoot {

/// A raster or vector file that GDAL reads, open, with what companions_of() it and nothing else (GdalDoor).
/// Used by the thread that made it; while it lives, GDAL's messages on that thread go to messages(). All
/// errors are InputErrors at the file, with GDAL's own words.
class GdalInput {
 public:
  /// Which of the formats a file is, decides format_of() and not its reader.
  GdalInput(const std::filesystem::path& file, std::initializer_list<FileFormat> expected);

  const SourcePlace& place() const { return place_; }
  const GdalMessages& messages() const { return messages_; }
  GDALDataset& dataset() const { return *dataset_; }
  /// Values of a row of a band as `type`. Throws InputError.
  void read_row(GDALRasterBand& band, int row, int column, int columns, GDALDataType type, void* out) const;

  /// With GDAL's first words.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  SourcePlace place_;
  GdalMessages messages_;
  GdalDoor door_;
  GDALDatasetUniquePtr dataset_;
};

}  // namespace tubefoot
