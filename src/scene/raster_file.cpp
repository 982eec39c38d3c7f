// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/raster_file.hpp"

#include <fmt/core.h>

#include <mutex>
#include <system_error>

#include "geometry/stop.hpp"
#include "scene/raster_block.hpp"
#include "scene/raster_netcdf_size.hpp"
#include "scene/vrt_sources.hpp"

namespace tubefoot {

RasterFile::RasterFile(const std::filesystem::path& file) : place_{file.string(), 0, 0} {
  static std::once_flag registered;
  std::call_once(registered, [] { GDALAllRegister(); });
  refuse_short_netcdf(place_);
  for (const std::filesystem::path& source : vrt_sources(file)) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(source, error))
      fail(fmt::format("is a virtual raster of '{}', which is no file", source.string()));
    refuse_short_netcdf({source.string(), 0, 0});
  }
  const char* const drivers[] = {"GTiff", "BAG", "AAIGrid", "netCDF", "VRT", nullptr};
  dataset_.reset(GDALDataset::Open(place_.file.c_str(),
                                   GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, drivers));
  if (dataset_ == nullptr) {
    fail(
        "cannot be read as GeoTIFF, BAG, ESRI ASCII grid, netCDF or VRT: it is empty, cut off, corrupt or of "
        "another format (gdal_translate converts many)");
  }
  if (dataset_->GetRasterCount() == 0) {
    fail(
        "holds no single raster but perhaps several variables: extract one with gdal_translate "
        "(gdalinfo lists their names)");
  }
  if (const auto problem = too_large_block(*dataset_)) fail(*problem);
}

std::string RasterFile::crs() const {
  const OGRSpatialReference* known = dataset_->GetSpatialRef();
  if (known == nullptr || known->IsEmpty() || known->IsLocal()) return {};
  return dataset_->GetProjectionRef();
}

std::array<double, 6> RasterFile::geotransform() const {
  std::array<double, 6> transform{};
  if (dataset_->GetGeoTransform(transform.data()) != CE_None) {
    fail("has no geotransform, so its cells have no size and place: add one with gdal_edit.py -a_ullr");
  }
  if (transform[2] != 0 || transform[4] != 0) {
    fail("is rotated against its coordinate axes: turn it north-up with gdalwarp");
  }
  if (!(transform[1] > 0) || !(transform[5] < 0)) {
    fail("does not run from north-west to south-east: turn it north-up with gdalwarp");
  }
  return transform;
}

RasterFile::Metres RasterFile::metres() const {
  GDALRasterBand& band = *dataset_->GetRasterBand(1);
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
    fail(fmt::format(
        "its heights are in '{}', expected m, cm, km, ft or US survey foot: mend it with gdal_edit.py "
        "-units m",
        unit));
  }
  const double scale = band.GetScale() == 0 ? 1 : band.GetScale();
  return {scale, band.GetOffset(), metres};
}

void RasterFile::read_row(int row, int column, int columns, double* values, unsigned char* has_data) const {
  stop_if_wanted();
  GDALRasterBand& band = *dataset_->GetRasterBand(1);
  read_row(band, row, column, columns, GDT_Float64, values);
  read_row(*band.GetMaskBand(), row, column, columns, GDT_Byte, has_data);
}

void RasterFile::read_row(GDALRasterBand& band, int row, int column, int columns, GDALDataType type,
                          void* out) const {
  if (band.RasterIO(GF_Read, column, row, columns, 1, out, columns, 1, type, 0, 0, nullptr) != CE_None) {
    // GDAL's last word names the file, which may be one of many in a virtual raster.
    const auto& told = messages_.failures();
    fail(fmt::format("row {} cannot be read: the file is cut off or corrupt{}", row,
                     told.size() > 1 ? ": " + told.back() : ""));
  }
}

void RasterFile::fail(const std::string& message) const {
  throw InputError(place_, message + messages_.in_brackets());
}

}  // namespace tubefoot
