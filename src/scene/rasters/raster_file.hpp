// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gdal_priv.h>

#include <array>
#include <filesystem>
#include <string>

#include "files/gdal_input.hpp"
#include "files/input_error.hpp"

namespace tubefoot {

/// An open raster of heights (band 1): GeoTIFF, BAG, ESRI ASCII grid, netCDF or VRT. Only the thread that
/// created it may use it, as for GdalInput.
class RasterFile {
 public:
  explicit RasterFile(const std::filesystem::path& file,
                      GdalInput::Variable variable = GdalInput::Variable::refused);

  const SourcePlace& place() const { return input_.place(); }
  const GdalMessages& messages() const { return input_.messages(); }
  bool has_variable_resolution() const { return input_.has_variable_resolution(); }
  int columns() const { return input_.dataset().GetRasterXSize(); }
  int rows() const { return input_.dataset().GetRasterYSize(); }
  std::string crs() const { return input_.crs(); }
  /// Returns the geotransform of a north-up raster. Throws if there is none, or if the raster is rotated or
  /// upside down.
  std::array<double, 6> geotransform() const;
  /// Converts values of the band to metres, by its scale, offset and unit.
  struct Metres {
    double scale = 1, offset = 0, metres_per_unit = 1;
    double operator()(double value) const { return (value * scale + offset) * metres_per_unit; }
  };
  Metres metres() const;
  /// Reads a part of a row: its values, and flags of the values that are data (not 0).
  void read_row(int row, int column, int columns, double* values, unsigned char* has_data) const;

  std::string advised(std::string_view command) const { return input_.advised(command); }
  std::string name_the_degrees() const { return input_.name_the_degrees(); }
  std::optional<std::string> unknown_row_order() const { return input_.unknown_row_order(); }

  [[noreturn]] void fail(const std::string& message) const { input_.fail(message); }

 private:
  GdalInput input_;
};

}  // namespace tubefoot
