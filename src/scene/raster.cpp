// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/raster.hpp"

#include <fmt/core.h>
#include <gdal_priv.h>

#include <array>
#include <cmath>
#include <limits>
#include <mutex>

#include "scene/raster_messages.hpp"
#include "scene/raster_netcdf_size.hpp"

namespace tubefoot {
namespace {

constexpr double kMostCells = 50e6;

struct Window {
  int column = 0, row = 0, columns = 0, rows = 0;  // in the file
  int step = 1;
  int kept_columns() const { return (columns + step - 1) / step; }
  int kept_rows() const { return (rows + step - 1) / step; }
};

// Degrees stay degrees until they are carried into the frame; heights are metres, positive up.
struct Heights {
  Window window;
  std::vector<glm::dvec3> points;     // of the cells with data: x, y in the raster's CRS
  std::vector<std::uint32_t> number;  // of a kept cell's point, row by row; kHole
};

constexpr std::uint32_t kHole = std::numeric_limits<std::uint32_t>::max();

class RasterReader {
 public:
  RasterReader(const RasterTerrain& terrain) : terrain_(terrain), place_{terrain.file.string(), 0, 0} {
    open();
  }

  std::string crs() const {
    const OGRSpatialReference* known = dataset_->GetSpatialRef();
    if (known == nullptr || known->IsEmpty() || known->IsLocal()) return {};
    return dataset_->GetProjectionRef();  // as WKT
  }

  Heights read() {
    Heights heights;
    heights.window = window();
    check_geotransform();
    GDALRasterBand& band = *dataset_->GetRasterBand(1);
    double scale = band.GetScale();
    if (scale == 0) scale = 1;
    const double metres = (terrain_.depth_positive_down ? -1 : 1) * metres_per_unit(band);
    const double offset = band.GetOffset();

    const Window& w = heights.window;
    heights.number.assign(static_cast<std::size_t>(w.kept_columns()) * w.kept_rows(), kHole);
    std::vector<double> values(w.columns);
    std::vector<unsigned char> has_data(w.columns);
    std::size_t cell = 0;
    for (int row = w.row; row < w.row + w.rows; row += w.step) {
      read_row(band, w, row, GDT_Float64, values.data());
      read_row(*band.GetMaskBand(), w, row, GDT_Byte, has_data.data());
      for (int i = 0; i < w.columns; i += w.step, ++cell) {
        if (has_data[i] == 0 || !std::isfinite(values[i])) continue;
        heights.number[cell] = static_cast<std::uint32_t>(heights.points.size());
        heights.points.push_back(place_of(w.column + i, row, (values[i] * scale + offset) * metres));
      }
    }
    return heights;
  }

  /// Middle of the window, in the raster's CRS.
  glm::dvec3 centre(const Window& w) const {
    return {geotransform_[0] + (w.column + 0.5 * w.columns) * geotransform_[1],
            geotransform_[3] + (w.row + 0.5 * w.rows) * geotransform_[5], 0};
  }

  const GdalMessages& messages() const { return messages_; }
  const SourcePlace& place() const { return place_; }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(place_, message + messages_.in_brackets());
  }

  void open() {
    static std::once_flag registered;
    std::call_once(registered, [] { GDALAllRegister(); });
    const char* const drivers[] = {"GTiff", "BAG", "AAIGrid", "netCDF", nullptr};
    dataset_.reset(GDALDataset::Open(place_.file.c_str(),
                                     GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, drivers));
    if (dataset_ == nullptr) {
      fail(
          "cannot be read as GeoTIFF, BAG, ESRI ASCII grid or netCDF: it is empty, cut off, corrupt or of "
          "another "
          "format (gdal_translate converts many)");
    }
    std::error_code error;
    if (const auto needed = netcdf_classic_size(terrain_.file);
        needed && std::filesystem::file_size(terrain_.file, error) < *needed) {
      fail("is cut off: its netCDF header describes more data than the file holds");
    }
    if (dataset_->GetRasterCount() == 0) {
      fail(
          "holds no single raster but perhaps several variables: extract one with gdal_translate "
          "(gdalinfo lists their names)");
    }
  }

  Window window() const {
    const int width = dataset_->GetRasterXSize(), height = dataset_->GetRasterYSize();
    Window w{0, 0, width, height, terrain_.decimate};
    if (w.step < 1) fail(fmt::format("decimate is {}, expected 1 or more", w.step));
    if (terrain_.window) {
      w.column = (*terrain_.window)[0];
      w.row = (*terrain_.window)[1];
      w.columns = (*terrain_.window)[2];
      w.rows = (*terrain_.window)[3];
      if (w.column < 0 || w.row < 0 || w.columns < 1 || w.rows < 1 || w.columns > width - w.column ||
          w.rows > height - w.row) {
        fail(fmt::format(
            "the window of {} x {} cells at column {}, row {} does not lie in the raster of {} x {} cells",
            w.columns, w.rows, w.column, w.row, width, height));
      }
    }
    if (w.kept_columns() < 2 || w.kept_rows() < 2) {
      fail(fmt::format(
          "{} x {} cells are left, expected at least 2 x 2: facets lie between the cells' centres",
          w.kept_columns(), w.kept_rows()));
    }
    if (static_cast<double>(w.kept_columns()) * w.kept_rows() > kMostCells) {
      fail(fmt::format("{} x {} cells are more than {:.3g}: give a window or decimate", w.kept_columns(),
                       w.kept_rows(), kMostCells));
    }
    return w;
  }

  void check_geotransform() {
    if (dataset_->GetGeoTransform(geotransform_.data()) != CE_None) {
      fail("has no geotransform, so its cells have no size and place: add one with gdal_edit.py -a_ullr");
    }
    if (geotransform_[2] != 0 || geotransform_[4] != 0) {
      fail("is rotated against its coordinate axes: turn it north-up with gdalwarp");
    }
    if (!(geotransform_[1] > 0) || !(geotransform_[5] < 0)) {
      fail("does not run from north-west to south-east: turn it north-up with gdalwarp");
    }
  }

  double metres_per_unit(GDALRasterBand& band) const {
    const std::string unit = band.GetUnitType();
    if (unit.empty() || unit == "m" || unit == "metre" || unit == "meter" || unit == "metres" ||
        unit == "meters") {
      return 1;
    }
    if (unit == "cm") return 0.01;
    if (unit == "km") return 1000;
    if (unit == "ft" || unit == "foot" || unit == "feet") return 0.3048;
    if (unit == "US survey foot" || unit == "ftUS") return 1200.0 / 3937.0;
    fail(fmt::format(
        "its heights are in '{}', expected m, cm, km, ft or US survey foot: mend it with gdal_edit.py "
        "-units m",
        unit));
  }

  void read_row(GDALRasterBand& band, const Window& w, int row, GDALDataType type, void* out) const {
    if (band.RasterIO(GF_Read, w.column, row, w.columns, 1, out, w.columns, 1, type, 0, 0, nullptr) !=
        CE_None) {
      fail(fmt::format("row {} cannot be read: the file is cut off or corrupt", row));
    }
  }

  glm::dvec3 place_of(int column, int row, double height_m) const {
    return {geotransform_[0] + (column + 0.5) * geotransform_[1],
            geotransform_[3] + (row + 0.5) * geotransform_[5], height_m};
  }

  const RasterTerrain& terrain_;
  SourcePlace place_;
  GdalMessages messages_;
  GDALDatasetUniquePtr dataset_;
  std::array<double, 6> geotransform_{};
};

// Two triangles between four centres that have data, one between three.
ComponentMesh facets_between(Heights heights) {
  ComponentMesh mesh;
  const std::size_t columns = heights.window.kept_columns(), rows = heights.window.kept_rows();
  const auto add = [&mesh](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (a != kHole && b != kHole && c != kHole) mesh.triangles.push_back({a, b, c});
  };
  for (std::size_t row = 0; row + 1 < rows; ++row) {
    for (std::size_t column = 0; column + 1 < columns; ++column) {
      const std::uint32_t* const north = &heights.number[row * columns + column];
      const std::uint32_t nw = north[0], ne = north[1], sw = north[columns], se = north[columns + 1];
      if (nw == kHole || ne == kHole || sw == kHole || se == kHole) ++mesh.hole_cells;
      if (nw == kHole || se == kHole) {
        add(sw, se, ne);
        add(sw, ne, nw);
      } else {
        add(sw, se, nw);
        add(se, ne, nw);
      }
    }
  }
  mesh.points_m = std::move(heights.points);
  drop_unused_points(mesh);
  return mesh;
}

// The frame of a scene without [georeference], from its first raster; and what to tell the user.
LocalFrame frame_about(glm::dvec3 centre, const std::string& crs, const SourcePlace& place,
                       std::string& warning) {
  if (crs.empty()) {
    warning = fmt::format(
        "{}: has no coordinate reference system; its coordinates are taken for local metres", place.file);
    return {};
  }
  // Origins are rounded so that the message gives them exactly.
  if (is_geographic(crs, place)) {
    const double latitude = std::round(centre.y * 1e6) / 1e6, longitude = std::round(centre.x * 1e6) / 1e6;
    warning = fmt::format(
        "{}: the scene has no [georeference]; the local frame is tangent to the Earth at latitude {:.6f}, "
        "longitude {:.6f}, the middle of the raster's window",
        place.file, latitude, longitude);
    return LocalFrame::at_lat_lon(latitude, longitude, 0);
  }
  const double easting = std::round(centre.x), northing = std::round(centre.y);
  warning = fmt::format(
      "{}: the scene has no [georeference]; the local frame lies along the raster's projection, origin at "
      "easting {:.0f}, northing {:.0f}, the middle of the raster's window",
      place.file, easting, northing);
  return LocalFrame::projected(crs, easting, northing, 0, place);
}

}  // namespace

ComponentMesh read_raster(const RasterTerrain& terrain, std::optional<LocalFrame>& frame) {
  RasterReader reader(terrain);
  const std::string crs = reader.crs();
  Heights heights = reader.read();
  const SourcePlace& place = reader.place();
  std::vector<std::string> warnings;
  if (!frame) frame = frame_about(reader.centre(heights.window), crs, place, warnings.emplace_back());
  if (frame->is_georeferenced()) {
    if (crs.empty()) {
      throw InputError(
          place,
          "has no coordinate reference system, but the scene's frame is georeferenced: add it with "
          "gdal_edit.py -a_srs EPSG:..., or remove [georeference]");
    }
    frame->carry(heights.points, crs, place);
  } else if (!crs.empty()) {
    throw InputError(
        place,
        "has a coordinate reference system, but a raster before it has none: add a [georeference] and "
        "the other raster's CRS with gdal_edit.py -a_srs EPSG:...");
  }
  ComponentMesh mesh = facets_between(std::move(heights));
  if (mesh.triangles.empty()) {
    throw InputError(
        place,
        "has no three neighbouring cells with data in the window, so it gives no facet: check the "
        "window and the nodata value");
  }
  for (const std::string& text : reader.messages().warnings()) {
    warnings.push_back(fmt::format("{}: GDAL: {}", place.file, text));
  }
  mesh.warnings = std::move(warnings);
  return mesh;
}

}  // namespace tubefoot
