// SPDX-License-Identifier: GPL-3.0-or-later

// Determines the geotransform and the order of rows of a netCDF variable from its coordinate variables,
// where GDAL's netCDF driver does not find them.

#include "files/netcdf_grid.hpp"

#include <cpl_conv.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include "files/advised_command.hpp"
#include "files/library_settings.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

constexpr const char* row_order = "GDAL_NETCDF_BOTTOMUP";

struct Axis {
  std::string name, type, unit;
  bool given = false, even = true;
  double first = 0, last = 0;
  GUInt64 count = 0;

  double step() const { return (last - first) / static_cast<double>(count - 1); }
  bool is_named(std::initializer_list<std::string_view> names) const {
    std::string lower = name;
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return std::ranges::find(names, lower) != names.end();
  }
  bool is_x() const {
    return type == GDAL_DIM_TYPE_HORIZONTAL_X ||
           (type != GDAL_DIM_TYPE_HORIZONTAL_Y && is_named({"x", "lon", "longitude", "easting", "east"}));
  }
  bool is_y() const {
    return type == GDAL_DIM_TYPE_HORIZONTAL_Y ||
           (type != GDAL_DIM_TYPE_HORIZONTAL_X && is_named({"y", "lat", "latitude", "northing", "north"}));
  }
};

Axis axis_of(const GDALDimension& dimension) {
  Axis axis{dimension.GetName(), dimension.GetType(), {}};
  axis.count = dimension.GetSize();
  const std::shared_ptr<GDALMDArray> variable = dimension.GetIndexingVariable();
  if (variable == nullptr || variable->GetDimensionCount() != 1 || axis.count < 2 ||
      variable->GetDataType().GetClass() != GEDTC_NUMERIC)
    return axis;
  axis.unit = variable->GetUnit();
  const double epsilon = variable->GetDataType().GetNumericDataType() == GDT_Float32
                             ? std::numeric_limits<float>::epsilon()
                             : std::numeric_limits<double>::epsilon();
  const auto value_at = [&](GUInt64 begin, std::size_t count, double* values) {
    const GInt64 step = 1;
    return variable->Read(&begin, &count, &step, nullptr, GDALExtendedDataType::Create(GDT_Float64), values);
  };
  if (!value_at(0, 1, &axis.first) || !value_at(axis.count - 1, 1, &axis.last)) return axis;
  axis.given = true;
  const double step = axis.step();
  constexpr GUInt64 at_once = 1 << 16;
  std::vector<double> values(std::min(at_once, axis.count));
  for (GUInt64 begin = 0; begin < axis.count && axis.even; begin += at_once) {
    const auto count = static_cast<std::size_t>(std::min(at_once, axis.count - begin));
    axis.even = value_at(begin, count, values.data());
    for (std::size_t k = 0; k < count && axis.even; ++k) {
      const double expected = axis.first + static_cast<double>(begin + k) * step;
      axis.even = std::abs(values[k] - expected) <= 1e-3 * std::abs(step) + 2 * epsilon * std::abs(expected);
    }
  }
  if (!(std::abs(step) > 0) || !std::isfinite(step)) axis.even = false;
  return axis;
}

bool is_metres(std::string_view unit) {
  return unit.empty() || unit == "m" || unit == "metre" || unit == "meter" || unit == "metres" ||
         unit == "meters";
}

}  // namespace

NetcdfGrid netcdf_grid(const fs::path& file, GDALDataset& raster) {
  NetcdfGrid grid;
  const char* const variable = raster.GetRasterBand(1)->GetMetadataItem("NETCDF_VARNAME");
  if (variable == nullptr) return grid;
  constexpr const char* drivers[] = {"netCDF", nullptr};
  const CPLErrorHandlerPusher quiet(
      CPLQuietErrorHandler);  // the code that opened the raster received all messages
  const GDALDatasetUniquePtr whole(
      GDALDataset::Open(plain_name(file).c_str(), GDAL_OF_MULTIDIM_RASTER | GDAL_OF_READONLY, drivers));
  const std::shared_ptr<GDALGroup> root = whole == nullptr ? nullptr : whole->GetRootGroup();
  const std::string name = variable;
  const std::shared_ptr<GDALMDArray> array =
      root == nullptr ? nullptr : root->OpenMDArrayFromFullname(name.starts_with('/') ? name : "/" + name);
  if (array == nullptr || array->GetDimensionCount() < 2) return grid;
  const auto& dimensions = array->GetDimensions();
  const std::size_t count = dimensions.size();
  const Axis y = axis_of(*dimensions[count - 2]), x = axis_of(*dimensions[count - 1]);
  if (y.is_x() && x.is_y()) {
    grid.turned_over = true;
    grid.problem =
        count == 2
            ? fmt::format(
                  "stores '{0}' with the dimensions ({1}, {2}), so its rows run along {2}: transpose it with "
                  "{3}",
                  name, y.name, x.name,
                  advised_command(fmt::format("gdalmdimtranslate -array 'name={},transpose=[1,0]'", name),
                                  file, ".nc"))
            : fmt::format(
                  "stores '{0}' with the dimensions ({1}, {2}), so its rows run along {2}, expected ({2}, "
                  "{1})",
                  name, y.name, x.name);
    return grid;
  }
  if (!y.given || !x.given) return grid;
  grid.says_rows = y.last != y.first;
  grid.first_row_is_north = y.last < y.first;
  grid.in_degrees = (x.unit.empty() && x.is_named({"lon", "longitude"})) ||
                    (y.unit.empty() && y.is_named({"lat", "latitude"})) || x.unit.starts_with("degree") ||
                    y.unit.starts_with("degree");
  if (raster.GetSpatialRef() != nullptr || grid.in_degrees || (is_metres(x.unit) && is_metres(y.unit))) {
    const double west = std::min(x.first, x.last), north = std::max(y.first, y.last), dx = x.step(),
                 dy = std::abs(y.step());
    if (x.even && y.even && dx > 0)
      grid.geotransform = {west - dx / 2, dx, 0, north + dy / 2, 0, -dy};
    else
      grid.problem = fmt::format(
          "its coordinates '{}' {}: expected evenly spaced coordinates that increase from column to column; "
          "resample the raster",
          x.even && !y.even ? y.name : x.name, x.even && y.even ? "decrease" : "are not evenly spaced");
  } else {
    grid.problem = fmt::format("its coordinates are in '{}', expected m: write them in metres",
                               is_metres(x.unit) ? y.unit : x.unit);
  }
  return grid;
}

std::string NetcdfGrid::placing(int columns, int rows) const {
  const auto& g = geotransform.value();
  return fmt::format("{} -a_ullr {} {} {} {}", NetcdfRowOrder::option(first_row_is_north), g[0], g[3],
                     g[0] + columns * g[1], g[3] + rows * g[5]);
}

NetcdfRowOrder::NetcdfRowOrder(bool first_row_is_north) {
  CPLSetThreadLocalConfigOption(row_order, first_row_is_north ? "NO" : "YES");
}

NetcdfRowOrder::~NetcdfRowOrder() { CPLSetThreadLocalConfigOption(row_order, nullptr); }

std::string NetcdfRowOrder::option(bool first_row_is_north) {
  return fmt::format("--config {} {}", row_order, first_row_is_north ? "NO" : "YES");
}

}  // namespace tubefoot
