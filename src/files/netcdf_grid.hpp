// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gdal_priv.h>

#include <array>
#include <filesystem>
#include <optional>
#include <string>

namespace tubefoot {

/// The positions of the cells of a two-dimensional netCDF variable, by the file's coordinate variables
/// (y(y), x(x)).
/// GDAL's netCDF driver takes the first row as the southernmost, unless attributes mark these variables as
/// coordinates. It does so regardless of their values.
struct NetcdfGrid {
  /// Whether the file determines which row is the northernmost, and whether that row is the first.
  bool says_rows = false, first_row_is_north = false;
  /// The geotransform of equally spaced coordinates, with north up.
  std::optional<std::array<double, 6>> geotransform;
  /// Whether the names denote longitude and latitude.
  bool in_degrees = false;
  /// Whether rows run along x and columns along y.
  bool turned_over = false;
  /// Reason why the variable cannot be read as a map, and a remedy; empty if it can be read.
  std::string problem;

  /// Returns the options of gdal_translate that write the variable as it is read here. Requires a
  /// geotransform.
  std::string placing(int columns, int rows) const;
};

/// Reads the grid of a netCDF file. `raster` is the same file as GDAL's raster, with at least one band.
NetcdfGrid netcdf_grid(const std::filesystem::path& file, GDALDataset& raster);

/// While an object exists, GDAL opens netCDF files on this thread with the first row in the south or in the
/// north. GDAL's rows then run from the north.
class NetcdfRowOrder {
 public:
  explicit NetcdfRowOrder(bool first_row_is_north);
  ~NetcdfRowOrder();
  NetcdfRowOrder(const NetcdfRowOrder&) = delete;
  NetcdfRowOrder& operator=(const NetcdfRowOrder&) = delete;

  /// Returns the same setting for GDAL's programs: an option and its value.
  static std::string option(bool first_row_is_north);
};

}  // namespace tubefoot
