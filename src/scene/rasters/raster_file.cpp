// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/rasters/raster_file.hpp"

#include <fmt/core.h>

#include <mutex>
#include <system_error>

#include "files/advised_command.hpp"
#include "geometry/steps/stop.hpp"
namespace tubefoot {

RasterFile::RasterFile(const std::filesystem::path& file, GdalInput::Variable variable)
    : input_(file,
             {FileFormat::geotiff, FileFormat::bag, FileFormat::ascii_grid, FileFormat::netcdf4,
              FileFormat::netcdf_classic, FileFormat::vrt},
             variable) {
  if (input_.dataset().GetRasterCount() == 0) fail(input_.no_single_raster());
  input_.refuse_colours("heights");
}

std::array<double, 6> RasterFile::geotransform() const {
  const auto transform = input_.geotransform();
  if (!transform) fail(input_.no_geotransform());
  const auto turn = [this] { return advised(fmt::format("gdalwarp {}", warp_heights)); };
  if ((*transform)[2] != 0 || (*transform)[4] != 0)
    fail(fmt::format("is rotated relative to its coordinate axes: turn it north-up with {}", turn()));
  if (!((*transform)[1] > 0) || !((*transform)[5] < 0))
    fail(fmt::format("does not run from north-west to south-east: turn it north-up with {}", turn()));
  return *transform;
}

RasterFile::Metres RasterFile::metres() const {
  GDALRasterBand& band = *input_.dataset().GetRasterBand(1);
  const std::string unit = band.GetUnitType();
  double metres = 1;
  if (unit == "cm") {
    metres = 0.01;
  } else if (unit == "km") {
    metres = 1000;
  } else if (unit == "ft" || unit == "foot" || unit == "feet") {
    metres = 0.3048;
  } else if (unit == "US survey foot" || unit == "ftUS") {
    metres = 1200.0 / 3937.0;
  } else if (!unit.empty() && unit != "m" && unit != "metre" && unit != "meter" && unit != "metres" &&
             unit != "meters") {
    const std::string copy = advised_command("gdal_translate -unscale -ot Float64", place().file);
    fail(fmt::format(
        "its heights are in '{0}', expected m, cm, km, ft or US survey foot: write a copy in metres with "
        "`{1} && "
        "gdal_edit.py -scale METRES -units m {2}`, where METRES is the length of one {0}",
        unit, copy.substr(1, copy.size() - 2), shell_word(new_file_beside(place().file, ".tif"))));
  }
  const double scale = band.GetScale() == 0 ? 1 : band.GetScale();
  return {scale, band.GetOffset(), metres};
}

void RasterFile::read_row(int row, int column, int columns, double* values, unsigned char* has_data) const {
  GDALRasterBand& band = *input_.dataset().GetRasterBand(1);
  input_.read_row(band, row, column, columns, GDT_Float64, values);
  input_.read_row(*band.GetMaskBand(), row, column, columns, GDT_Byte, has_data);
}

}  // namespace tubefoot
