// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/raster.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <limits>

#include "scene/raster_file.hpp"

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
  explicit RasterReader(const RasterTerrain& terrain) : terrain_(terrain), file_(terrain.file) {}

  const RasterFile& file() const { return file_; }

  Heights read() {
    Heights heights;
    heights.window = window();
    geotransform_ = file_.geotransform();
    const RasterFile::Metres metres = file_.metres();
    const double up = terrain_.depth_positive_down ? -1 : 1;

    const Window& w = heights.window;
    heights.number.assign(static_cast<std::size_t>(w.kept_columns()) * w.kept_rows(), kHole);
    std::vector<double> values(w.columns);
    std::vector<unsigned char> has_data(w.columns);
    std::size_t cell = 0;
    for (int row = w.row; row < w.row + w.rows; row += w.step) {
      file_.read_row(row, w.column, w.columns, values.data(), has_data.data());
      for (int i = 0; i < w.columns; i += w.step, ++cell) {
        if (has_data[i] == 0 || !std::isfinite(values[i])) continue;
        heights.number[cell] = static_cast<std::uint32_t>(heights.points.size());
        heights.points.push_back(place_of(w.column + i, row, up * metres(values[i])));
      }
    }
    return heights;
  }

  /// Middle of the window, in the raster's CRS.
  glm::dvec3 centre(const Window& w) const {
    return {geotransform_[0] + (w.column + 0.5 * w.columns) * geotransform_[1],
            geotransform_[3] + (w.row + 0.5 * w.rows) * geotransform_[5], 0};
  }

 private:
  Window window() const {
    const int width = file_.columns(), height = file_.rows();
    Window w{0, 0, width, height, terrain_.decimate};
    if (w.step < 1) file_.fail(fmt::format("decimate is {}, expected 1 or more", w.step));
    if (terrain_.window) {
      w.column = (*terrain_.window)[0];
      w.row = (*terrain_.window)[1];
      w.columns = (*terrain_.window)[2];
      w.rows = (*terrain_.window)[3];
      if (w.column < 0 || w.row < 0 || w.columns < 1 || w.rows < 1 || w.columns > width - w.column ||
          w.rows > height - w.row) {
        file_.fail(fmt::format(
            "the window of {} x {} cells at column {}, row {} does not lie in the raster of {} x {} cells",
            w.columns, w.rows, w.column, w.row, width, height));
      }
    }
    if (w.kept_columns() < 2 || w.kept_rows() < 2) {
      file_.fail(fmt::format(
          "{} x {} cells are left, expected at least 2 x 2: facets lie between the cells' centres",
          w.kept_columns(), w.kept_rows()));
    }
    if (static_cast<double>(w.kept_columns()) * w.kept_rows() > kMostCells) {
      file_.fail(fmt::format("{} x {} cells are more than {:.3g}: give a window or decimate",
                             w.kept_columns(), w.kept_rows(), kMostCells));
    }
    return w;
  }

  glm::dvec3 place_of(int column, int row, double height_m) const {
    return {geotransform_[0] + (column + 0.5) * geotransform_[1],
            geotransform_[3] + (row + 0.5) * geotransform_[5], height_m};
  }

  const RasterTerrain& terrain_;
  RasterFile file_;
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
  const std::string crs = reader.file().crs();
  Heights heights = reader.read();
  const SourcePlace& place = reader.file().place();
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
  for (const glm::dvec3& p : heights.points)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw InputError(
          place, fmt::format("has a cell with data at ({:g}, {:g}, {:g}): check its geotransform, scale and "
                             "offset with gdalinfo",
                             p.x, p.y, p.z));
  ComponentMesh mesh = facets_between(std::move(heights));
  if (mesh.triangles.empty()) {
    throw InputError(
        place,
        "has no three neighbouring cells with data in the window, so it gives no facet: check the "
        "window and the nodata value");
  }
  for (const std::string& text : reader.file().messages().warnings()) {
    warnings.push_back(fmt::format("{}: GDAL: {}", place.file, text));
  }
  mesh.warnings = std::move(warnings);
  return mesh;
}

}  // namespace tubefoot
