// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// Weighted means of values on a grid of square cells, east and north in the local frame. It grows where
/// values fall: memory goes with the area covered (16 bytes a cell, in tiles), not with the number of values.
/// Cell (i, j) covers [i, i + 1) x [j, j + 1) cells from the frame's origin. What lies within a millionth of
/// a cell below a border is taken to lie on it: round numbers stay on their side whatever rounding did to
/// them.
class CellMeans {
 public:
  static constexpr std::size_t default_most_bytes = std::size_t{1} << 30;

  /// Throws std::invalid_argument for a cell that is not positive.
  explicit CellMeans(double cell_m, std::size_t most_bytes = default_most_bytes);

  /// Throws std::runtime_error where memory would exceed most_bytes, which says what to do; the value is then
  /// left out and all others are kept. `value` and the place must be finite, the weight positive.
  void add(double east_m, double north_m, double value, double weight = 1);

  double cell_m() const { return cell_m_; }
  bool empty() const { return tiles_.empty(); }
  /// The cells with values: [west, east) x [south, north).
  struct Extent {
    std::int64_t west = 0, south = 0, east = 0, north = 0;
    std::int64_t columns() const { return east - west; }
    std::int64_t rows() const { return north - south; }
  };
  const Extent& extent() const { return extent_; }
  /// Mean of a cell; NaN where no value fell.
  double mean(std::int64_t column, std::int64_t row) const;

 private:
  static constexpr std::int64_t tile_cells = 128;
  struct Sum {
    double value = 0, weight = 0;
  };
  using Tile = std::array<Sum, tile_cells * tile_cells>;
  using Key = std::pair<std::int64_t, std::int64_t>;  ///< row, column of the tile

  double cell_m_;
  std::size_t most_bytes_;
  std::map<Key, std::unique_ptr<Tile>> tiles_;
  Key last_key_{std::numeric_limits<std::int64_t>::min(), 0};
  Tile* last_ = nullptr;
  Extent extent_;
};

/// Nodata of the rasters written here.
inline constexpr float no_data = -32768;

/// Writes the cells as a Float32 GeoTIFF (deflate, tiled), north up, no_data where nothing fell, on the map
/// of the frame (LocalFrame::map): a projected frame's own CRS; the orthographic projection about a tangent
/// frame's origin; no CRS but local metres for a frame without georeference. Throws std::runtime_error naming
/// the file, for cells without any value too.
void write_cells(const std::filesystem::path& file, const CellMeans& cells, const LocalFrame& frame,
                 const char* band_name, const char* unit);

}  // namespace tubefoot
