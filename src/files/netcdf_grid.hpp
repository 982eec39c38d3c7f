// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gdal_priv.h>

#include <array>
#include <filesystem>
#include <optional>
#include <string>

namespace tubefoot {

/// Where the cells of a two-dimensional variable of a netCDF file lie, by the file's own coordinate variables
/// (y(y), x(x)). GDAL's netCDF driver takes a file's first row for the southernmost unless attributes of
/// those variables say that they are coordinates, whatever their values are.
struct NetcdfGrid {
  /// Whether the file says which of its rows is the northernmost; and if so, whether that is the first.
  bool says_rows = false, first_row_is_north = false;
  /// North-up, of evenly spaced coordinates.
  std::optional<std::array<double, 6>> geotransform;
  /// The names say longitude and latitude.
  bool in_degrees = false;
  /// Its rows run along x and its columns along y.
  bool turned_over = false;
  /// Why the variable cannot be read as a map, and what to do; empty if it can.
  std::string problem;

  /// Options of gdal_translate that make it write the variable as it is read here; with a geotransform only.
  std::string placing(int columns, int rows) const;
};

/// `raster`: the same file as GDAL's raster, with at least one band.
NetcdfGrid netcdf_grid(const std::filesystem::path& file, GDALDataset& raster);

/// While one lives, GDAL opens netCDF files on this thread with their first row in the south, or in the
/// north. GDAL's rows then run from the north.
class NetcdfRowOrder {
 public:
  explicit NetcdfRowOrder(bool first_row_is_north);
  ~NetcdfRowOrder();
  NetcdfRowOrder(const NetcdfRowOrder&) = delete;
  NetcdfRowOrder& operator=(const NetcdfRowOrder&) = delete;

  /// The same for GDAL's programs: an option and its value.
  static std::string option(bool first_row_is_north);
};

}  // namespace tubefoot
