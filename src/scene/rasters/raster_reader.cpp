// SPDX-License-Identifier: GPL-3.0-or-later

// Reads windows of a raster of heights as points, and determines the local frame from the first raster of a
// scene. It warns of implausible extents and values.

#include "scene/rasters/raster_reader.hpp"

#include <fmt/core.h>

#include <cmath>

namespace tubefoot {
namespace {

RasterWindow window_of(const RasterTerrain& terrain, const RasterFile& file) {
  const int width = file.columns(), height = file.rows();
  RasterWindow w{0, 0, width, height, terrain.decimate};
  if (w.step < 1) file.fail(fmt::format("decimate is {}, expected at least 1", w.step));
  if (terrain.window) {
    w.column = (*terrain.window)[0];
    w.row = (*terrain.window)[1];
    w.columns = (*terrain.window)[2];
    w.rows = (*terrain.window)[3];
    if (w.column < 0 || w.row < 0 || w.columns < 1 || w.rows < 1 || w.columns > width - w.column ||
        w.rows > height - w.row) {
      file.fail(fmt::format(
          "the window of {} x {} cells at column {}, row {} does not lie in the raster of {} x {} cells",
          w.columns, w.rows, w.column, w.row, width, height));
    }
  }
  if (file.has_variable_resolution()) {
    if (w.step > 1)
      file.fail("has variable resolution, which cannot be decimated: give resolution_m instead");
    return w;
  }
  if (terrain.resolution_m > 0)
    file.fail(fmt::format(
        "has one resolution, but resolution_m applies only to BAGs of variable resolution: give decimate, or "
        "resample the raster with {}",
        file.advised(fmt::format("gdalwarp -tr {0} {0} {1}", terrain.resolution_m, warp_heights))));
  if (w.kept_columns() < 2 || w.kept_rows() < 2) {
    file.fail(
        fmt::format("{} x {} cells are left, expected at least 2 x 2: facets connect the centres of cells",
                    w.kept_columns(), w.kept_rows()));
  }
  return w;
}

// Largest plausible ratio of a terrain's height to its width.
constexpr double steepest = 10;

// Returns the frame of a scene without [georeference] from its first raster, and a warning for the user.
LocalFrame frame_about(glm::dvec3 centre, const std::string& crs, const SourcePlace& place,
                       std::string& warning) {
  if (crs.empty()) {
    warning = fmt::format(
        "{}: has no coordinate reference system; its coordinates are read as metres in the local frame",
        place.file);
    return {};
  }
  // Origins are rounded, so that the message gives them exactly.
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
      "{}: the scene has no [georeference]; the local frame uses the raster's projection, with its origin at "
      "easting {:.0f}, northing {:.0f}, the middle of the raster's window",
      place.file, easting, northing);
  return LocalFrame::projected(crs, easting, northing, 0, place);
}

}  // namespace

RasterReader::RasterReader(const RasterTerrain& terrain)
    : file_(terrain.file, GdalInput::Variable::overview),
      window_(window_of(terrain, file_)),
      geotransform_(file_.geotransform()),
      metres_(file_.metres()),
      up_(terrain.depth_positive_down ? -1 : 1),
      crs_(file_.crs()) {}

std::vector<std::string> RasterReader::settle(std::optional<LocalFrame>& frame) const {
  const SourcePlace& place = file_.place();
  std::vector<std::string> warnings;
  if (!frame) {
    const glm::dvec3 centre{geotransform_[0] + (window_.column + 0.5 * window_.columns) * geotransform_[1],
                            geotransform_[3] + (window_.row + 0.5 * window_.rows) * geotransform_[5], 0};
    frame = frame_about(centre, crs_, place, warnings.emplace_back());
  }
  if (frame->is_georeferenced() && crs_.empty()) {
    throw InputError(
        place,
        fmt::format("has no coordinate reference system, but the scene's frame is georeferenced: write a "
                    "copy with one by {}, or remove [georeference]",
                    file_.advised("gdal_translate -a_srs EPSG:...")));
  }
  if (!frame->is_georeferenced() && !crs_.empty()) {
    throw InputError(place,
                     "has a coordinate reference system, but a preceding raster has none: add a "
                     "[georeference], and write a copy of the other raster with its own coordinate reference "
                     "system by `gdal_translate -a_srs EPSG:... IN OUT`");
  }
  return warnings;
}

void RasterReader::carry(std::span<glm::dvec3> points, const LocalFrame& frame) const {
  if (frame.is_georeferenced()) frame.carry(points, crs_, file_.place());
  for (const glm::dvec3& p : points)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      file_.fail(
          fmt::format("has a cell with data at ({:g}, {:g}, {:g}): check its geotransform, scale and offset "
                      "with gdalinfo",
                      p.x, p.y, p.z));
}

double RasterReader::metres_per_unit() const {
  if (crs_.empty()) return 1;
  OGRSpatialReference crs;
  return crs.importFromWkt(crs_.c_str()) == OGRERR_NONE ? crs.GetLinearUnits() : 1;
}

std::vector<std::string> RasterReader::odd_extent(glm::dvec3 lo, glm::dvec3 hi) const {
  // Values that programs often write into cells without data, without declaring them.
  for (const double value : {-9999.0, -99999.0, -32768.0, -32767.0, 9999.0, 99999.0})
    if (const double height = height_m(value); lo.z < hi.z && (height == lo.z || height == hi.z))
      return {fmt::format(
          "{}: has cells with the value {:g}, which often stands for missing data, but does not declare "
          "this: if these cells have no data, {} makes them holes",
          file_.place().file, value, file_.advised(fmt::format("gdal_translate -a_nodata {:g}", value)))};
  const glm::dvec3 size = hi - lo;
  if (!crs_.empty() || lo.x < -180 || hi.x > 360 || lo.y < -90 || hi.y > 90 ||
      size.z <= steepest * std::max(size.x, size.y))
    return {};
  file_.fail(fmt::format(
      "has no coordinate reference system; in metres, its {:.3g} x {:.3g} m would be {:.3g} m high, so its "
      "coordinates look like degrees (longitude {:.6g} to {:.6g}, latitude {:.6g} to {:.6g}): {}",
      size.x, size.y, size.z, lo.x, hi.x, lo.y, hi.y, file_.name_the_degrees()));
}

std::vector<std::string> RasterReader::warnings() const {
  std::vector<std::string> warnings;
  for (const std::string& text : file_.messages().warnings())
    warnings.push_back(fmt::format("{}: GDAL: {}", file_.place().file, text));
  return warnings;
}

void RasterReader::read_row(int row, int column, int count, std::vector<glm::dvec3>& points,
                            std::uint32_t* numbers) {
  const int file_row = window_.row + row * window_.step, first = window_.column + column * window_.step,
            columns = (count - 1) * window_.step + 1;
  values_.resize(static_cast<std::size_t>(columns));
  has_data_.resize(static_cast<std::size_t>(columns));
  file_.read_row(file_row, first, columns, values_.data(), has_data_.data());
  const double y = geotransform_[3] + (file_row + 0.5) * geotransform_[5];
  for (int k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k * window_.step);
    numbers[k] = hole;
    if (has_data_[i] == 0 || !std::isfinite(values_[i])) continue;
    numbers[k] = static_cast<std::uint32_t>(points.size());
    points.emplace_back(geotransform_[0] + (first + k * window_.step + 0.5) * geotransform_[1], y,
                        height_m(values_[i]));
  }
}

}  // namespace tubefoot
