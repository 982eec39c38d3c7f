// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/description/scene_component.hpp"
#include "scene/description/terrain_description.hpp"
#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// Returns whether a raster terrain is read by tiles: as its description states, or because it is large.
/// Throws InputError as read_raster() does.
bool is_read_by_tiles(const TerrainDescription& terrain);

/// A raster terrain with only some tiles in memory at a time. Tiles are squares of cells and count row by
/// row from the north-west corner. A cell lies between the centres of four pixels and holds the facets that
/// read_raster() would create there. docs/notes/visibility.md
class TerrainTiles {
 public:
  static constexpr int cells_a_side = 64;

  struct Tile {
    /// Bounding box of its facets and of all facets that share a vertex with them; empty (lo above hi) if
    /// there are none.
    glm::dvec3 lo_m{std::numeric_limits<double>::infinity()}, hi_m{-std::numeric_limits<double>::infinity()};
    std::uint32_t facets = 0;
    bool has_holes = false;  ///< whether a cell is incomplete
  };

  /// Reads the whole raster once, by windows. `frame` is as in read_raster(). Throws InputError.
  TerrainTiles(const RasterTerrain& terrain, std::optional<LocalFrame>& frame);

  const std::vector<Tile>& tiles() const { return tiles_; }
  std::size_t columns() const { return tile_columns_; }
  std::size_t rows() const { return tile_rows_; }
  /// Returns the number of facets of all tiles.
  std::uint64_t facets() const { return facets_; }
  std::uint64_t vertices() const { return vertices_; }
  std::size_t hole_cells() const { return hole_cells_; }
  double longest_edge_m() const { return longest_edge_m_; }
  glm::dvec3 lo_m() const { return lo_m_; }
  glm::dvec3 hi_m() const { return hi_m_; }
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// Returns the tiles that may have a facet above or below a position.
  std::vector<std::uint32_t> at(double east_m, double north_m) const;

  /// Returns the facets of some tiles (increasing numbers), in the order of read_raster(). Thread-safe.
  /// Throws InputError for a file that can no longer be read.
  ComponentMesh read(std::span<const std::uint32_t> tiles) const;
  /// Returns the numbers that read_raster() gives to the facets of read(), in its order.
  std::vector<std::uint64_t> numbers_of(std::span<const std::uint32_t> tiles) const;
  /// Returns the number of the first facet of a row of tiles; beyond the last row, the number of all
  /// facets.
  std::uint64_t first_of_row(std::size_t row) const;

 private:
  /// Tiles [first, end) of one row of tiles.
  struct Run {
    std::uint32_t first, end;
  };
  struct Part;
  Part survey_part(int row, int column) const;
  std::vector<std::vector<Run>> runs_of(std::span<const std::uint32_t> tiles) const;

  RasterTerrain terrain_;
  LocalFrame frame_;
  int cell_columns_ = 0, cell_rows_ = 0;
  std::size_t tile_columns_ = 0, tile_rows_ = 0;
  std::vector<Tile> tiles_;
  std::vector<std::uint8_t> row_facets_;  ///< [row of cells][column of tiles]; empty without holes
  std::vector<std::uint64_t> row_first_;  ///< number of a row's first facet; empty without holes
  std::uint64_t facets_ = 0, vertices_ = 0;
  std::size_t hole_cells_ = 0;
  double longest_edge_m_ = 0;
  glm::dvec3 lo_m_{std::numeric_limits<double>::infinity()}, hi_m_{-std::numeric_limits<double>::infinity()};
  std::vector<std::string> warnings_;
};

}  // namespace tubefoot
