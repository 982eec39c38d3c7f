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

/// A CRS as WKT; empty for none, and for one that only says that coordinates are local.
std::string crs_text(const OGRSpatialReference* crs);

/// Options of gdalwarp for heights and for classes. Cells outside of the source become holes: without them,
/// gdalwarp gives these 0, which is a height and a class.
inline constexpr const char* warp_heights = "-r bilinear -ot Float64 -dstnodata nan";
inline constexpr const char* warp_classes = "-r near -ot Float64 -dstnodata nan";

/// A raster or vector file that GDAL reads, open, with what companions_of() it and nothing else (GdalAccess).
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
  /// From columns and rows of a raster to its coordinates: as GDAL knows it, or of a netCDF variable by its
  /// coordinates. Rows of netCDF run from the north where the file has coordinates, and from the file's last
  /// to its first where it has none.
  std::optional<std::array<double, 6>> geotransform() const;
  /// What to say of a raster without a geotransform, and the command that adds one. `otherwise`: a key of the
  /// scene that makes it unnecessary, or nothing.
  std::string no_geotransform(std::string_view otherwise = "") const;
  /// What to say of a file without a band, and the command that takes out one of its variables.
  std::string no_single_raster() const;
  /// What to say of a netCDF variable that does not say which of its rows is the northernmost; nothing of
  /// others. The last one is taken for it.
  std::optional<std::string> unknown_row_order() const;
  /// A command that writes what is advised into a new file (advised_command()), from this file as it is read
  /// here: with the geotransform and the order of rows that GDAL's programs would not find.
  std::string advised(std::string_view command) const;
  /// What to do about a raster of degrees that does not say whose.
  std::string name_the_degrees() const;
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
  GdalAccess access_;
  GDALDatasetUniquePtr dataset_;
  bool variable_resolution_ = false, in_degrees_ = false;
  std::optional<NetcdfGrid> netcdf_;  ///< of a netCDF variable that GDAL has no geotransform of
};

}  // namespace tubefoot
