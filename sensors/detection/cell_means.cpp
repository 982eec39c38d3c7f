// SPDX-License-Identifier: GPL-3.0-or-later
// Sums values by cells of a square grid, and writes the weighted means as a GeoTIFF. The sums are kept in
// tiles, so that memory depends on the covered area only.

#include "sensors/detection/cell_means.hpp"

#include <cpl_vsi.h>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "files/checked_file.hpp"
#include "files/gdal_access.hpp"
#include "files/gdal_messages.hpp"

namespace tubefoot {
namespace {

void require_size(double cell_m) {
  if (!(cell_m > 0) || !std::isfinite(cell_m))
    throw std::invalid_argument(fmt::format("the cell size is {} m, but must be positive", cell_m));
}

}  // namespace

CellSums::CellSums(double cell_m) : cell_m_(cell_m) { require_size(cell_m); }

void CellSums::refuse(double east_m, double north_m, double value) {
  throw std::invalid_argument(
      fmt::format("invalid value {} at east {} m, north {} m", value, east_m, north_m));
}

void CellSums::merge() {
  const auto place = [](const CellSum& sum) { return std::pair(sum.row, sum.column); };
  std::ranges::stable_sort(sums_, {}, place);
  std::size_t count = 0;
  for (const CellSum& sum : sums_)
    if (count > 0 && place(sums_[count - 1]) == place(sum)) {
      sums_[count - 1].value += sum.value;
      sums_[count - 1].weight += sum.weight;
    } else {
      sums_[count++] = sum;
    }
  sums_.resize(count);
  merge_at_ = std::max(few, 2 * count);
}

CellMeans::CellMeans(double cell_m, std::size_t most_bytes) : cell_m_(cell_m), most_bytes_(most_bytes) {
  require_size(cell_m);
}

void CellMeans::add(double east_m, double north_m, double value, double weight) {
  add(CellSums::of_one(east_m, north_m, value, weight, cell_m_));
}

void CellMeans::add(const CellSums& sums) {
  if (sums.cell_m() != cell_m_)
    throw std::invalid_argument(
        fmt::format("sums in cells of {} m cannot be added to cells of {} m", sums.cell_m(), cell_m_));
  for (const CellSum& sum : sums.sums()) add(sum);
}

void CellMeans::add(const CellSum& one) {
  const auto [column, row, value, weight] = one;
  const Key key{row >> tile_bits, column >> tile_bits};
  if (key != last_key_) {
    auto found = tiles_.find(key);
    if (found == tiles_.end()) {
      if ((tiles_.size() + 1) * sizeof(Tile) > most_bytes_)
        throw std::runtime_error(
            fmt::format("cells of {} m in this area need more than {} MiB: use larger cells", cell_m_,
                        most_bytes_ >> 20));
      found = tiles_.emplace(key, std::make_unique<Tile>()).first;
    }
    last_key_ = key;
    last_ = found->second.get();
  }
  Sum& sum = (*last_)[place_in_tile(column, row)];
  sum.value += value;
  sum.weight += weight;
  if (extent_.east == extent_.west) extent_ = {column, row, column + 1, row + 1};
  extent_ = {std::min(extent_.west, column), std::min(extent_.south, row), std::max(extent_.east, column + 1),
             std::max(extent_.north, row + 1)};
}

double CellMeans::mean(std::int64_t column, std::int64_t row) const {
  const auto found = tiles_.find({row >> tile_bits, column >> tile_bits});
  if (found == tiles_.end()) return std::numeric_limits<double>::quiet_NaN();
  const Sum& sum = (*found->second)[place_in_tile(column, row)];
  return sum.weight > 0 ? sum.value / sum.weight : std::numeric_limits<double>::quiet_NaN();
}

void write_cells(const std::filesystem::path& file, const CellMeans& cells, const LocalFrame& frame,
                 const char* band_name, const char* unit) {
  const GdalMessages messages;
  const auto require = [&](bool good, const std::string& reason) {
    if (!good) throw write_error(file, reason + messages.in_brackets());
  };
  require(!cells.empty(), "there is nothing to write, because no value lies in a cell");
  const CellMeans::Extent& extent = cells.extent();
  constexpr std::int64_t most_side = 1 << 20, most_cells = std::int64_t{1} << 32;
  require(extent.columns() <= most_side && extent.rows() <= most_side &&
              extent.columns() * extent.rows() <= most_cells,
          fmt::format("{} x {} cells of {} m are too many for one raster: use larger cells", extent.columns(),
                      extent.rows(), cells.cell_m()));

  // Encodes the file in memory, where it is smaller than the cells themselves. write_file then writes it.
  register_gdal_drivers();
  struct MemoryFile {
    std::string name;
    ~MemoryFile() { VSIUnlink(name.c_str()); }
  } const memory{fmt::format("/vsimem/cells-{}.tif", static_cast<const void*>(&cells))};
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  require(driver != nullptr, "GDAL has no GeoTIFF driver");
  const std::array<const char*, 6> options{"COMPRESS=DEFLATE", "PREDICTOR=3",    "TILED=YES",
                                           "BIGTIFF=IF_SAFER", "SPARSE_OK=TRUE", nullptr};
  const auto columns = static_cast<int>(extent.columns()), rows = static_cast<int>(extent.rows());
  std::unique_ptr<GDALDataset> dataset(
      driver->Create(memory.name.c_str(), columns, rows, 1, GDT_Float32, const_cast<char**>(options.data())));
  require(dataset != nullptr, "cannot encode the raster");

  const LocalFrame::Map map = frame.map();
  const double cell = cells.cell_m() / map.metres_per_unit;
  std::array<double, 6> transform{map.easting + static_cast<double>(extent.west) * cell,   cell, 0,
                                  map.northing + static_cast<double>(extent.north) * cell, 0,    -cell};
  dataset->SetGeoTransform(transform.data());
  if (!map.crs_wkt.empty()) {
    OGRSpatialReference crs;
    require(crs.importFromWkt(map.crs_wkt.c_str()) == OGRERR_NONE,
            "cannot write the coordinate reference system");
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    dataset->SetSpatialRef(&crs);
  }
  GDALRasterBand* band = dataset->GetRasterBand(1);
  band->SetNoDataValue(no_data);
  band->SetDescription(band_name);
  band->SetUnitType(unit);
  std::vector<float> line(static_cast<std::size_t>(columns));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double mean = cells.mean(extent.west + column, extent.north - 1 - row);
      line[static_cast<std::size_t>(column)] = std::isnan(mean) ? no_data : static_cast<float>(mean);
    }
    require(
        band->RasterIO(GF_Write, 0, row, columns, 1, line.data(), columns, 1, GDT_Float32, 0, 0) == CE_None,
        "cannot encode the raster");
  }
  GDALClose(dataset.release());
  require(messages.failures().empty(), "cannot encode the raster");
  vsi_l_offset size = 0;
  const GByte* bytes = VSIGetMemFileBuffer(memory.name.c_str(), &size, FALSE);
  require(bytes != nullptr, "cannot encode the raster");
  write_file(file, {bytes, static_cast<std::size_t>(size)});
}

}  // namespace tubefoot
