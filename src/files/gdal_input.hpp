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

/// A CRS as WKT; empty for none, and for one that only says that coordinates are local.
std::string crs_text(const OGRSpatialReference* crs);

/// What to do about a raster of degrees that does not say whose.
inline constexpr const char* name_the_degrees =
    "name it with gdal_translate -a_srs EPSG:4326 (WGS 84), or bring it to metres with gdalwarp -s_srs "
    "EPSG:4326 "
    "-t_srs EPSG:... -r bilinear";

/// A raster or vector file that GDAL reads, open, with what companions_of() it and nothing else (GdalDoor).
/// Used by the thread that made it; while it lives, GDAL's messages on that thread go to messages(). All
/// errors are InputErrors at the file, with GDAL's own words.
class GdalInput {
 public:
  /// What is to be had of a BAG of variable resolution: nothing, as its raster is a coarse overview, or that.
  enum class Variable { refused, overview };

  /// Which of the formats a file is, decides format_of() and not its reader.
  GdalInput(const std::filesystem::path& file, std::initializer_list<FileFormat> expected,
            Variable variable = Variable::refused);

  const SourcePlace& place() const { return place_; }
  const GdalMessages& messages() const { return messages_; }
  GDALDataset& dataset() const { return *dataset_; }
  /// Whether this is a BAG with grids in its cells (BagRefinements).
  bool has_variable_resolution() const { return variable_resolution_; }
  /// Of a raster, as WKT; empty for none, or one that lies nowhere on Earth. Throws InputError for one
  /// without, whose file says that its coordinates are degrees: of which datum, nobody should have to guess.
  std::string crs() const;
  /// Throws InputError for a picture in colours, whose first band (red, or a palette's numbers) is not `what`
  /// is wanted of it.
  void refuse_colours(const char* what, bool palettes_too = true) const;
  /// Values of a row of a band as `type`. Throws InputError.
  void read_row(GDALRasterBand& band, int row, int column, int columns, GDALDataType type, void* out) const;

  /// With GDAL's first words.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  SourcePlace place_;
  GdalMessages messages_;
  GdalDoor door_;
  GDALDatasetUniquePtr dataset_;
  bool variable_resolution_ = false;
};

}  // namespace tubefoot
