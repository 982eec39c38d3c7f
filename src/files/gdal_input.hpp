// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gdal_priv.h>

#include <array>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>

#include "files/file_format.hpp"
#include "files/gdal_access.hpp"
#include "files/gdal_messages.hpp"
#include "files/input_error.hpp"
#include "files/netcdf_grid.hpp"

namespace tubefoot {

/// Returns a CRS as WKT; empty if there is none, or if it only states that coordinates are local.
std::string crs_text(const OGRSpatialReference* crs);

/// Options of gdalwarp for heights and for classes. Cells outside of the source have no data. By default,
/// gdalwarp gives them 0, which is a valid height and class.
inline constexpr const char* warp_heights = "-r bilinear -ot Float64 -dstnodata nan";
inline constexpr const char* warp_classes = "-r near -ot Float64 -dstnodata nan";

/// An open raster or vector file for GDAL, which can open this file and its companions_of() only
/// (GdalAccess).
/// Only the thread that created the object may use it. While the object exists, messages() collects GDAL's
/// messages on that thread. All errors are InputErrors at the file and quote GDAL.
class GdalInput {
 public:
  /// Treatment of a BAG of variable resolution, whose raster is a coarse overview: an error, or use of the
  /// overview.
  enum class Variable { refused, overview };

  /// format_of() determines the format of the file, not a GDAL driver.
  GdalInput(const std::filesystem::path& file, std::initializer_list<FileFormat> expected,
            Variable variable = Variable::refused);

  const SourcePlace& place() const { return place_; }
  const GdalMessages& messages() const { return messages_; }
  GDALDataset& dataset() const { return *dataset_; }
  /// Returns whether the file is a BAG with grids in its cells (BagRefinements).
  bool has_variable_resolution() const { return variable_resolution_; }
  /// Returns the transformation from columns and rows of a raster to coordinates: GDAL's, or that of the
  /// coordinates of a netCDF variable. Rows of netCDF run from the north if the file has coordinates.
  /// Otherwise they run from the last row of the file to the first.
  std::optional<std::array<double, 6>> geotransform() const;
  /// Returns the message for a raster without a geotransform, with the command that adds one. `otherwise`
  /// is a scene key that makes a geotransform unnecessary, or empty.
  std::string no_geotransform(std::string_view otherwise = "") const;
  /// Returns the message for a file without a band, with the command that extracts one of its variables.
  std::string no_single_raster() const;
  /// Returns the message for a netCDF variable whose northernmost row is unknown; empty for other files. In
  /// this case the last row counts as the northernmost.
  std::optional<std::string> unknown_row_order() const;
  /// Returns a command that applies the advice to this file and writes a new one (advised_command()). The
  /// command sets the geotransform and the order of rows as tubefoot reads them, because GDAL's programs
  /// would not find them.
  std::string advised(std::string_view command) const;
  /// Returns the advice for a raster in degrees of an unknown datum.
  std::string name_the_degrees() const;
  /// Returns the CRS of a raster as WKT; empty if there is none, or if it has no position on Earth. Throws
  /// InputError if there is no CRS although the file states that coordinates are degrees, because their
  /// datum is unknown.
  std::string crs() const;
  /// Throws InputError for a colour picture, because its first band (red, or numbers of a palette) does not
  /// hold the quantity `what`.
  void refuse_colours(const char* what, bool palettes_too = true) const;
  /// Reads values of a row of a band as `type`. Throws InputError.
  void read_row(GDALRasterBand& band, int row, int column, int columns, GDALDataType type, void* out) const;

  /// Throws InputError with the message and GDAL's first error.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  SourcePlace place_;
  GdalMessages messages_;
  GdalAccess access_;
  GDALDatasetUniquePtr dataset_;
  bool variable_resolution_ = false, in_degrees_ = false;
  std::optional<NetcdfGrid> netcdf_;  ///< for a netCDF variable without a geotransform in GDAL
};

}  // namespace tubefoot
