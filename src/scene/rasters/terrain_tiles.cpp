// SPDX-License-Identifier: GPL-3.0-or-later

// Reads a raster terrain by tiles. A first pass counts the facets and vertices of every tile and computes
// its bounding box. Facets of chosen tiles then get the numbers of read_raster() (docs/notes/visibility.md).

#include "scene/rasters/terrain_tiles.hpp"

#include <fmt/core.h>
#include <gdal.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "files/limits.hpp"
#include "geometry/steps/stop.hpp"
#include "scene/rasters/raster_reader.hpp"

namespace tubefoot {
namespace {

constexpr int side = TerrainTiles::cells_a_side;
/// Side in tiles of a square of the first pass: large against the blocks of a file, small against memory.
constexpr int tiles_a_part = 16;
/// Largest number of cells that a scene loads as a whole by default: about 4 GB of facets, vertices and
/// tree.
constexpr double most_cells_whole = 20e6;
/// Size of GDAL's cache of blocks. Its default is a fraction of all memory.
constexpr std::int64_t gdal_cache_bytes = 128 << 20;

std::uint32_t tiles_of(int cells) { return static_cast<std::uint32_t>((cells + side - 1) / side); }

struct Interval {  // of points
  int first, end;
};

void add(std::vector<Interval>& list, Interval more) {
  if (!list.empty() && more.first <= list.back().end)
    list.back().end = std::max(list.back().end, more.end);
  else
    list.push_back(more);
}

}  // namespace

bool is_read_by_tiles(const TerrainDescription& terrain) {
  const auto* raster = std::get_if<RasterTerrain>(&terrain.kind);
  if (raster == nullptr || terrain.facets || raster->load == "whole") return false;
  if (raster->load == "tiles") return true;
  const RasterReader reader(*raster);
  return !reader.file().has_variable_resolution() && reader.window().cells() > most_cells_whole;
}

/// Results for one square of the first pass.
struct TerrainTiles::Part {
  std::uint32_t first_row, first_column, rows, columns;  // the tiles of the square, and one more on each side
  std::vector<Tile> tiles;                               // [row][column]
  std::vector<std::uint8_t> row_facets;  // [row of the square's cells][column of the square's tiles]
  glm::dvec3 lo_m{std::numeric_limits<double>::infinity()}, hi_m{-std::numeric_limits<double>::infinity()};
  std::uint64_t vertices = 0;
  std::size_t hole_cells = 0;
  double longest2 = 0;
  std::vector<std::string> warnings;
};

TerrainTiles::Part TerrainTiles::survey_part(int part_row, int part_column) const {
  constexpr int cells = tiles_a_part * side;
  const int row0 = part_row * cells, column0 = part_column * cells, rows = std::min(cells, cell_rows_ - row0),
            columns = std::min(cells, cell_columns_ - column0);
  Part part;
  part.rows = tiles_of(rows) + 2;
  part.columns = tiles_of(columns) + 2;
  part.first_row = static_cast<std::uint32_t>(part_row * tiles_a_part);
  part.first_column = static_cast<std::uint32_t>(part_column * tiles_a_part);
  part.tiles.resize(std::size_t(part.rows) * part.columns);
  part.row_facets.resize(static_cast<std::size_t>(rows) * (part.columns - 2));

  RasterReader reader(terrain_);
  std::vector<glm::dvec3> points;
  const auto width = static_cast<std::size_t>(columns) + 1;
  std::vector<std::uint32_t> numbers(width * (static_cast<std::size_t>(rows) + 1));
  for (int row = 0; row <= rows; ++row)
    reader.read_row(row0 + row, column0, columns + 1, points,
                    &numbers[static_cast<std::size_t>(row) * width]);
  reader.carry(points, frame_);
  part.warnings = reader.warnings();

  std::vector<bool> used(points.size());
  for (int row = 0; row < rows; ++row) {
    stop_if_wanted();
    for (int column = 0; column < columns; ++column) {
      const std::uint32_t* const north = &numbers[static_cast<std::size_t>(row) * width + column];
      glm::dvec3 lo(std::numeric_limits<double>::infinity()), hi = -lo;
      std::uint8_t facets = 0;
      const bool hole =
          join_centres(north[0], north[1], north[width], north[width + 1],
                       [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
                         ++facets;
                         for (const std::uint32_t v : {a, b, c}) {
                           lo = glm::min(lo, points[v]);
                           hi = glm::max(hi, points[v]);
                           used[v] = true;
                         }
                         for (const glm::dvec3& edge :
                              {points[b] - points[a], points[c] - points[b], points[a] - points[c]})
                           part.longest2 = std::max(part.longest2, glm::dot(edge, edge));
                       });
      const int tile_row = row / side + 1, tile_column = column / side + 1;
      Tile& own = part.tiles[static_cast<std::size_t>(tile_row) * part.columns + tile_column];
      own.facets += facets;
      own.has_holes |= hole;
      part.hole_cells += hole;
      part.row_facets[static_cast<std::size_t>(row) * (part.columns - 2) + tile_column - 1] += facets;
      if (facets == 0) continue;
      part.lo_m = glm::min(part.lo_m, lo);
      part.hi_m = glm::max(part.hi_m, hi);
      // Tiles that share a corner of the cell get its bounds, too.
      const int south = row % side == side - 1 ? 1 : 0, east = column % side == side - 1 ? 1 : 0,
                up = row % side == 0 ? 1 : 0, west = column % side == 0 ? 1 : 0;
      for (int r = tile_row - up; r <= tile_row + south; ++r)
        for (int c = tile_column - west; c <= tile_column + east; ++c) {
          Tile& tile = part.tiles[static_cast<std::size_t>(r) * part.columns + c];
          tile.lo_m = glm::min(tile.lo_m, lo);
          tile.hi_m = glm::max(tile.hi_m, hi);
        }
    }
  }
  // A vertex on a border counts with the square to its south or east, or with the last square.
  for (int row = 0; row < rows + (row0 + rows == cell_rows_ ? 1 : 0); ++row)
    for (int column = 0; column < columns + (column0 + columns == cell_columns_ ? 1 : 0); ++column) {
      const std::uint32_t number = numbers[static_cast<std::size_t>(row) * width + column];
      part.vertices += number != RasterReader::hole && used[number];
    }
  return part;
}

TerrainTiles::TerrainTiles(const RasterTerrain& terrain, std::optional<LocalFrame>& frame)
    : terrain_(terrain) {
  GDALSetCacheMax64(std::min(static_cast<std::int64_t>(GDALGetCacheMax64()), gdal_cache_bytes));
  const RasterReader reader(terrain);
  if (reader.file().has_variable_resolution())
    reader.file().fail("has variable resolution, which cannot be loaded in tiles: omit load");
  warnings_ = reader.settle(frame);
  frame_ = *frame;
  cell_columns_ = reader.window().kept_columns() - 1;
  cell_rows_ = reader.window().kept_rows() - 1;
  tile_columns_ = tiles_of(cell_columns_);
  tile_rows_ = tiles_of(cell_rows_);
  if (reader.window().cells() > limits::tiled_cells)
    reader.file().fail(fmt::format("{} x {} cells exceed the limit of {:.3g}: give a window or decimate",
                                   cell_columns_ + 1, cell_rows_ + 1, limits::tiled_cells));
  tiles_.resize(tile_columns_ * tile_rows_);
  // A row of cells in a tile has at most 128 facets, so that a byte holds their number.
  row_facets_.resize(static_cast<std::size_t>(cell_rows_) * tile_columns_);

  const int part_rows = (cell_rows_ + side * tiles_a_part - 1) / (side * tiles_a_part),
            part_columns = (cell_columns_ + side * tiles_a_part - 1) / (side * tiles_a_part);
  // Each square takes about 40 MB.
  tbb::task_arena arena(std::min(tbb::this_task_arena::max_concurrency(), 8));
  for (int part_row = 0; part_row < part_rows; ++part_row) {
    std::vector<Part> parts(static_cast<std::size_t>(part_columns));
    arena.execute([&] {
      tbb::parallel_for(0, part_columns, [&](int column) {
        parts[static_cast<std::size_t>(column)] = survey_part(part_row, column);
      });
    });
    for (const Part& part : parts) {
      for (std::uint32_t r = 0; r < part.rows; ++r)
        for (std::uint32_t c = 0; c < part.columns; ++c) {
          const std::uint32_t row = part.first_row + r - 1, column = part.first_column + c - 1;
          if (row >= tile_rows_ || column >= tile_columns_) continue;  // also one before the first
          const Tile& found = part.tiles[std::size_t(r) * part.columns + c];
          Tile& tile = tiles_[row * tile_columns_ + column];
          tile.lo_m = glm::min(tile.lo_m, found.lo_m);
          tile.hi_m = glm::max(tile.hi_m, found.hi_m);
          tile.facets += found.facets;
          tile.has_holes |= found.has_holes;
        }
      const std::size_t own = part.columns - 2;
      for (std::size_t r = 0; r * own < part.row_facets.size(); ++r)
        std::copy_n(part.row_facets.begin() + static_cast<std::ptrdiff_t>(r * own), own,
                    row_facets_.begin() +
                        static_cast<std::ptrdiff_t>((std::size_t(part.first_row) * side + r) * tile_columns_ +
                                                    part.first_column));
      lo_m_ = glm::min(lo_m_, part.lo_m);
      hi_m_ = glm::max(hi_m_, part.hi_m);
      vertices_ += part.vertices;
      hole_cells_ += part.hole_cells;
      longest_edge_m_ = std::max(longest_edge_m_, part.longest2);
      for (const std::string& text : part.warnings)
        if (std::find(warnings_.begin(), warnings_.end(), text) == warnings_.end()) warnings_.push_back(text);
    }
  }
  longest_edge_m_ = std::sqrt(longest_edge_m_);
  for (int row = 0; row < cell_rows_; ++row) {
    row_first_.push_back(facets_);
    for (std::size_t c = 0; c < tile_columns_; ++c)
      facets_ += row_facets_[static_cast<std::size_t>(row) * tile_columns_ + c];
  }
  if (facets_ == 0)
    throw InputError(
        reader.file().place(),
        "does not contain three neighbouring cells with data in the window, so no facets can be formed: "
        "check the window and the nodata value");
  for (std::string& text : reader.odd_extent(lo_m_, hi_m_)) warnings_.push_back(std::move(text));
  if (hole_cells_ == 0) {
    row_facets_ = {};
    row_first_ = {};
  }
}

std::vector<std::vector<TerrainTiles::Run>> TerrainTiles::runs_of(
    std::span<const std::uint32_t> tiles) const {
  std::vector<std::vector<Run>> runs(tile_rows_);
  for (const std::uint32_t tile : tiles) {
    std::vector<Run>& row = runs[tile / tile_columns_];
    const auto column = static_cast<std::uint32_t>(tile % tile_columns_);
    if (!row.empty() && row.back().end == column)
      ++row.back().end;
    else
      row.push_back({column, column + 1});
  }
  return runs;
}

std::vector<std::uint32_t> TerrainTiles::at(double east_m, double north_m) const {
  std::vector<std::uint32_t> found;
  for (std::uint32_t k = 0; k < tiles_.size(); ++k)
    if (tiles_[k].lo_m.x <= east_m && east_m <= tiles_[k].hi_m.x && tiles_[k].lo_m.y <= north_m &&
        north_m <= tiles_[k].hi_m.y)
      found.push_back(k);
  return found;
}

ComponentMesh TerrainTiles::read(std::span<const std::uint32_t> tiles) const {
  ComponentMesh mesh;
  if (tiles.empty()) return mesh;
  RasterReader reader(terrain_);
  if (reader.window().kept_columns() != cell_columns_ + 1 || reader.window().kept_rows() != cell_rows_ + 1)
    reader.file().fail("changed while tubefoot read it");
  const std::vector<std::vector<Run>> runs = runs_of(tiles);
  const auto points_of = [this](const Run& run) {
    return Interval{static_cast<int>(run.first) * side,
                    std::min(static_cast<int>(run.end) * side, cell_columns_) + 1};
  };
  std::uint64_t facets = 0;
  for (const std::uint32_t tile : tiles) facets += tiles_[tile].facets;
  mesh.triangles.reserve(facets);
  mesh.points_m.reserve(facets / 2 + facets / 16);
  std::vector<std::uint32_t> north(static_cast<std::size_t>(cell_columns_) + 1, RasterReader::hole),
      south = north;
  const auto add_facet = [&mesh](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.triangles.push_back({a, b, c});
  };
  std::vector<Run> both;
  std::vector<Interval> intervals;
  for (int row = 0; row <= cell_rows_; ++row) {
    // The points of a row of tiles, and those at the end of the row of tiles above.
    const auto below = static_cast<std::size_t>(row / side);
    const bool ends = row > 0 && (row % side == 0 || row == cell_rows_);
    const std::size_t above = static_cast<std::size_t>(row - 1) / side;
    both.clear();
    if (row < cell_rows_) both = runs[below];
    if (ends) both.insert(both.end(), runs[above].begin(), runs[above].end());
    if (both.empty()) {
      if (row % side != 0) continue;
      row += side - 1;  // no tile of this row is chosen
      continue;
    }
    std::sort(both.begin(), both.end(), [](const Run& a, const Run& b) { return a.first < b.first; });
    intervals.clear();
    for (const Run& run : both) add(intervals, points_of(run));
    for (const Interval& i : intervals)
      reader.read_row(row, i.first, i.end - i.first, mesh.points_m,
                      &south[static_cast<std::size_t>(i.first)]);
    if (row > 0)
      for (const Run& run : runs[above]) {
        const Interval points = points_of(run);
        for (auto k = static_cast<std::size_t>(points.first); k + 1 < static_cast<std::size_t>(points.end);
             ++k)
          mesh.hole_cells += join_centres(north[k], north[k + 1], south[k], south[k + 1], add_facet);
      }
    north.swap(south);
  }
  reader.carry(mesh.points_m, frame_);
  if (mesh.triangles.size() != facets) reader.file().fail("changed while tubefoot read it");
  drop_unused_points(mesh);
  return mesh;
}

std::uint64_t TerrainTiles::first_of_row(std::size_t row) const {
  const std::size_t cells = row * side;
  if (cells >= static_cast<std::size_t>(cell_rows_)) return facets_;
  return row_first_.empty() ? 2 * std::uint64_t(cells) * static_cast<std::uint64_t>(cell_columns_)
                            : row_first_[cells];
}

std::vector<std::uint64_t> TerrainTiles::numbers_of(std::span<const std::uint32_t> tiles) const {
  std::vector<std::uint64_t> numbers;
  const std::vector<std::vector<Run>> runs = runs_of(tiles);
  for (std::size_t row = 0; row < static_cast<std::size_t>(cell_rows_); ++row)
    for (const Run& run : runs[row / side]) {
      std::uint64_t first, count = 0;
      if (row_facets_.empty()) {
        const auto begin = std::uint64_t(run.first) * side,
                   end = std::min(std::uint64_t(run.end) * side, std::uint64_t(cell_columns_));
        first = 2 * (row * static_cast<std::uint64_t>(cell_columns_) + begin);
        count = 2 * (end - begin);
      } else {
        first = row_first_[row];
        const std::uint8_t* const of_row = &row_facets_[row * tile_columns_];
        for (std::uint32_t c = 0; c < run.first; ++c) first += of_row[c];
        for (std::uint32_t c = run.first; c < run.end; ++c) count += of_row[c];
      }
      for (std::uint64_t k = 0; k < count; ++k) numbers.push_back(first + k);
    }
  return numbers;
}

}  // namespace tubefoot
