// SPDX-License-Identifier: GPL-3.0-or-later

// Reads a measured relief map from a raster and places it on a lattice along the frame's axes. A map that
// is not aligned is resampled: Newton's method finds the cell of each node, and heights are interpolated
// bilinearly.

#include "scene/surfaces/relief_map.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <utility>

#include "engine/relief/map_surface.hpp"
#include "files/limits.hpp"
#include "geometry/steps/stop.hpp"
#include "scene/rasters/raster_file.hpp"

namespace tubefoot {
namespace {

// Positions of the centres of a raster's cells in the local frame. Cells count from the north-west, from 0.
class CellPlaces {
 public:
  CellPlaces(const RasterFile& raster, const LocalFrame& frame)
      : frame_(frame), place_(raster.place()), crs_(raster.crs()), transform_(raster.geotransform()) {
    if (frame.is_georeferenced() && crs_.empty()) {
      raster.fail(
          fmt::format("has no coordinate reference system, but the scene's frame is georeferenced: write a "
                      "copy with one by {}, "
                      "or give tile_m",
                      raster.advised("gdal_translate -a_srs EPSG:...")));
    }
    if (!frame.is_georeferenced() && !crs_.empty()) {
      raster.fail(
          "has a coordinate reference system, but the scene's frame is not georeferenced: add "
          "[georeference], or give tile_m");
    }
  }

  // Transforms columns and rows, with fractions, to positions in the frame.
  std::vector<glm::dvec2> operator()(const std::vector<glm::dvec2>& cells) const {
    std::vector<glm::dvec3> points;
    points.reserve(cells.size());
    for (const glm::dvec2& cell : cells)
      points.emplace_back(transform_[0] + (cell.x + 0.5) * transform_[1],
                          transform_[3] + (cell.y + 0.5) * transform_[5], frame_.origin_height_m());
    if (frame_.is_georeferenced()) frame_.carry(points, crs_, place_);
    return {points.begin(), points.end()};
  }

 private:
  const LocalFrame& frame_;
  SourcePlace place_;
  std::string crs_;
  std::array<double, 6> transform_;
};

// Returns heights row by row from the north-west, as in the file; 0 where there is no data.
std::vector<double> read_heights(const RasterFile& raster, double scale) {
  const int columns = raster.columns(), rows = raster.rows();
  if (columns < 2 || rows < 2)
    raster.fail(fmt::format("has {} x {} cells, expected at least 2 x 2", columns, rows));
  if (static_cast<double>(columns) * rows > limits::cells)
    raster.fail(fmt::format("{} x {} cells exceed the limit of {:.3g}: reduce the raster with {}", columns,
                            rows, limits::cells, raster.advised("gdal_translate -r average -outsize 25% 0")));
  const RasterFile::Metres metres = raster.metres();
  std::vector<double> heights(static_cast<std::size_t>(columns) * rows);
  std::vector<unsigned char> has_data(columns);
  for (int row = 0; row < rows; ++row) {
    double* const values = heights.data() + static_cast<std::size_t>(row) * columns;
    raster.read_row(row, 0, columns, values, has_data.data());
    for (int i = 0; i < columns; ++i) {
      values[i] = has_data[i] != 0 && std::isfinite(values[i]) ? scale * metres(values[i]) : 0;
      if (!(std::abs(values[i]) <= 1e4))
        raster.fail(
            fmt::format("has a height of {:.6g} m above the facets, expected -10000 to 10000 m: check its "
                        "unit, nodata value and 'scale'",
                        values[i]));
    }
  }
  return heights;
}

void turn_south_up(std::vector<double>& heights, std::size_t columns) {
  const std::size_t rows = heights.size() / columns;
  const auto row = [&](std::size_t j) { return heights.begin() + static_cast<std::ptrdiff_t>(j * columns); };
  for (std::size_t j = 0; j < rows / 2; ++j) std::swap_ranges(row(j), row(j + 1), row(rows - 1 - j));
}

// Returns equally spaced cells along the raster's border.
std::vector<glm::dvec2> border_cells(double columns, double rows) {
  std::vector<glm::dvec2> cells;
  constexpr int steps = 16;
  for (int n = 0; n <= steps; ++n) {
    const double x = (columns - 1) * n / steps, y = (rows - 1) * n / steps;
    cells.insert(cells.end(), {{x, 0}, {x, rows - 1}, {0, y}, {columns - 1, y}});
  }
  return cells;
}

// Steps of a column and of a row in the frame at the raster's centre, and their inverse.
struct Steps {
  glm::dvec2 column, row;
  glm::dvec2 cells(glm::dvec2 way) const {
    const double area = column.x * row.y - column.y * row.x;
    return glm::dvec2(way.x * row.y - way.y * row.x, column.x * way.y - column.y * way.x) / area;
  }
};

double bilinear(const std::vector<double>& heights, std::ptrdiff_t columns, std::ptrdiff_t rows,
                glm::dvec2 cell) {
  const double x = std::floor(cell.x), y = std::floor(cell.y);
  const auto at = [&](std::ptrdiff_t i, std::ptrdiff_t j) {
    return i < 0 || j < 0 || i >= columns || j >= rows ? 0.0 : heights[j * columns + i];
  };
  if (!(x >= -1 && y >= -1 && x < static_cast<double>(columns) && y < static_cast<double>(rows))) return 0;
  const auto i = static_cast<std::ptrdiff_t>(x), j = static_cast<std::ptrdiff_t>(y);
  const double u = cell.x - x, v = cell.y - y;
  return (1 - v) * ((1 - u) * at(i, j) + u * at(i + 1, j)) +
         v * ((1 - u) * at(i, j + 1) + u * at(i + 1, j + 1));
}

// Resamples the heights on a lattice along the frame's axes. Newton's method with the steps at the raster's
// centre finds the cell of each node.
HeightMap resampled(const RasterFile& raster, const CellPlaces& places, const std::vector<double>& heights,
                    const Steps& steps) {
  const double columns = raster.columns(), rows = raster.rows();
  glm::dvec2 lo(HUGE_VAL), hi(-HUGE_VAL);
  for (const glm::dvec2& p : places(border_cells(columns, rows))) lo = glm::min(lo, p), hi = glm::max(hi, p);
  const double spacing = std::min(glm::length(steps.column), glm::length(steps.row));
  const double wide = std::ceil((hi.x - lo.x) / spacing) + 1, high = std::ceil((hi.y - lo.y) / spacing) + 1;
  if (!(wide * high <= limits::cells))
    raster.fail(fmt::format("would have {:.3g} x {:.3g} nodes in the scene's frame: project it with {}", wide,
                            high, raster.advised(fmt::format("gdalwarp -t_srs EPSG:... {}", warp_heights))));
  HeightMap map{static_cast<std::size_t>(wide),
                static_cast<std::size_t>(high),
                lo.x,
                lo.y,
                spacing,
                spacing,
                false,
                {}};
  const glm::dvec2 middle_cell{(columns - 1) / 2, (rows - 1) / 2}, middle = places({middle_cell}).front();
  map.height_m.reserve(map.columns * map.rows);
  // Nodes are transformed in large groups, because each call creates a transformation.
  const std::size_t rows_at_once = std::max<std::size_t>(1, (std::size_t{1} << 18) / map.columns);
  std::vector<glm::dvec2> nodes, cells;
  for (std::size_t first = 0; first < map.rows; first += rows_at_once) {
    stop_if_wanted();
    nodes.clear();
    cells.clear();
    for (std::size_t j = first; j < std::min(map.rows, first + rows_at_once); ++j)
      for (std::size_t i = 0; i < map.columns; ++i) {
        nodes.push_back(lo + spacing * glm::dvec2(static_cast<double>(i), static_cast<double>(j)));
        cells.push_back(middle_cell + steps.cells(nodes.back() - middle));
      }
    constexpr int iterations = 4;
    for (int n = 0; n < iterations; ++n) {
      const std::vector<glm::dvec2> reached = places(cells);
      for (std::size_t i = 0; i < cells.size(); ++i) cells[i] += steps.cells(nodes[i] - reached[i]);
    }
    for (const glm::dvec2& cell : cells)
      map.height_m.push_back(bilinear(heights, raster.columns(), raster.rows(), cell));
  }
  return map;
}

HeightMap placed(const RasterFile& raster, std::vector<double> heights, const LocalFrame& frame) {
  const CellPlaces places(raster, frame);
  const double columns = raster.columns(), rows = raster.rows();
  const glm::dvec2 middle{(columns - 1) / 2, (rows - 1) / 2};
  const std::vector<glm::dvec2> around = places({middle - glm::dvec2(0.5, 0), middle + glm::dvec2(0.5, 0),
                                                 middle - glm::dvec2(0, 0.5), middle + glm::dvec2(0, 0.5)});
  // If the map is aligned, one corner and the opposite corner determine all cells.
  const std::vector<glm::dvec2> corners = places({{0, rows - 1}, {columns - 1, 0}});
  const glm::dvec2 spacing = (corners[1] - corners[0]) / glm::dvec2(columns - 1, rows - 1);
  const std::vector<glm::dvec2> border = border_cells(columns, rows), reached = places(border);
  bool aligned = spacing.x > 0 && spacing.y > 0;
  for (std::size_t n = 0; n < border.size() && aligned; ++n) {
    const glm::dvec2 expected = corners[0] + spacing * glm::dvec2(border[n].x, rows - 1 - border[n].y);
    constexpr double cells = 1e-3;
    aligned = std::abs(reached[n].x - expected.x) <= cells * spacing.x &&
              std::abs(reached[n].y - expected.y) <= cells * spacing.y;
  }
  if (!aligned) return resampled(raster, places, heights, {around[1] - around[0], around[3] - around[2]});
  turn_south_up(heights, raster.columns());
  return {static_cast<std::size_t>(raster.columns()),
          static_cast<std::size_t>(raster.rows()),
          corners[0].x,
          corners[0].y,
          spacing.x,
          spacing.y,
          false,
          std::move(heights)};
}

// Limits the number of waves. The spectrum reports the removed part of a map wave by wave. The number of
// waves is the longer side of the map divided by the shorter side of a cell. Long narrow cells must not
// take minutes.
void check_spacing(const RasterFile& raster, const HeightMap& map) {
  constexpr double least_m = 1e-6, most_waves = 1e6;
  const double shortest = std::min(map.spacing_x_m, map.spacing_y_m),
               longest = std::max(static_cast<double>(map.columns) * map.spacing_x_m,
                                  static_cast<double>(map.rows) * map.spacing_y_m);
  if (!(shortest >= least_m && longest <= most_waves * shortest))
    raster.fail(fmt::format(
        "its cells are {:g} m by {:g} m over a length of {:g} m; expected sides of at least {:g} m and a "
        "length of at most {:.3g} times the shorter side: resample the raster to square cells with {}",
        map.spacing_x_m, map.spacing_y_m, longest, least_m, most_waves,
        raster.advised(fmt::format("gdalwarp -tr SIZE SIZE {}", warp_heights))));
}

}  // namespace

std::shared_ptr<const ElevationField> read_relief_map(const MapReliefDescription& map,
                                                      const LocalFrame& frame,
                                                      std::vector<std::string>& warnings) {
  const RasterFile raster(map.file);
  std::vector<double> heights = read_heights(raster, map.scale);
  HeightMap lattice;
  if (map.tile_m) {
    // The south-west corner is at the frame's origin, so that the first node is the centre of the cell
    // there.
    turn_south_up(heights, raster.columns());
    const double cell_m = *map.tile_m / raster.columns();
    lattice = {static_cast<std::size_t>(raster.columns()),
               static_cast<std::size_t>(raster.rows()),
               cell_m / 2,
               cell_m / 2,
               cell_m,
               cell_m,
               true,
               std::move(heights)};
  } else {
    lattice = placed(raster, std::move(heights), frame);
  }
  if (map.tile_m)
    if (const auto unknown = raster.unknown_row_order())
      warnings.push_back(
          fmt::format("{}: {}; tubefoot assumes that it is the last row", raster.place().file, *unknown));
  for (const std::string& text : raster.messages().warnings())
    warnings.push_back(fmt::format("{}: GDAL: {}", raster.place().file, text));
  check_spacing(raster, lattice);
  return make_surface(std::move(lattice));
}

}  // namespace tubefoot
