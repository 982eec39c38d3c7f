// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Weighted means of values on a grid of square cells, and their output as a GeoTIFF. The mean of a cell is
// the sum of value times weight over the sum of weights.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// Contribution of some values to one cell: the sum of value times weight, and the sum of the weights.
struct CellSum {
  std::int64_t column = 0, row = 0;
  double value = 0, weight = 0;
};

/// Sums of values from neighbouring positions, before they are added to a grid. Any thread can collect them,
/// and they are fewer than the values. A cell may have several sums, but the total is at most about twice
/// the number of cells.
class CellSums {
 public:
  /// Throws std::invalid_argument if the cell size is not positive.
  explicit CellSums(double cell_m);
  /// Adds a value as CellMeans::add() does, without its limit of memory.
  void add(double east_m, double north_m, double value, double weight) {
    const CellSum one = of_one(east_m, north_m, value, weight, cell_m_);
    // Consecutive points along a border fall into few cells in turn.
    constexpr std::size_t looked_at = 4;
    for (std::size_t k = sums_.size(); k > 0 && k + looked_at > sums_.size(); --k)
      if (CellSum& known = sums_[k - 1]; known.column == one.column && known.row == one.row) {
        known.value += one.value;
        known.weight += one.weight;
        return;
      }
    if (sums_.size() >= merge_at_) merge();
    sums_.push_back(one);
  }
  /// Contribution of one value to its cell.
  static CellSum of_one(double east_m, double north_m, double value, double weight, double cell_m) {
    constexpr double on_the_border = 1e-6;  // in cells
    const double x = east_m / cell_m + on_the_border, y = north_m / cell_m + on_the_border;
    constexpr double farthest = 1e15;  // in cells; beyond it, neighbouring cells are no longer resolved
    if (!(std::abs(x) < farthest) || !(std::abs(y) < farthest) || !std::isfinite(value) || !(weight > 0))
      refuse(east_m, north_m, value);
    const auto floor = [](double place) {
      const auto whole = static_cast<std::int64_t>(place);
      return whole - (static_cast<double>(whole) > place ? 1 : 0);
    };
    return {floor(x), floor(y), weight * value, weight};
  }
  double cell_m() const { return cell_m_; }
  const std::vector<CellSum>& sums() const { return sums_; }

 private:
  static constexpr std::size_t few = 4096;

  [[noreturn]] static void refuse(double east_m, double north_m, double value);
  /// Combines the sums of each cell, sorted by row and column. Rows of samples longer than a few cells
  /// return to each cell.
  void merge();

  double cell_m_;
  std::size_t merge_at_ = few;
  std::vector<CellSum> sums_;
};

/// Weighted means of values on a grid of square cells, east and north in the local frame. The grid grows as
/// values arrive. Its memory depends on the covered area (16 bytes per cell, in tiles), not on the number of
/// values. Cell (i, j) covers [i, i + 1) x [j, j + 1) cells from the frame's origin. A position within a
/// millionth of a cell below a border counts as on the border. Rounding therefore does not move round
/// numbers to the other side.
class CellMeans {
 public:
  static constexpr std::size_t default_most_bytes = std::size_t{1} << 30;

  /// Throws std::invalid_argument if the cell size is not positive.
  explicit CellMeans(double cell_m, std::size_t most_bytes = default_most_bytes);

  /// Adds a value at a position. Both must be finite, and the weight must be positive. Throws
  /// std::runtime_error with advice if memory would exceed most_bytes. The value is then omitted, and all
  /// earlier values are kept.
  void add(double east_m, double north_m, double value, double weight = 1);
  /// Adds the sums of cells of the same size. If memory runs out, that sum and all later ones are omitted.
  void add(const CellSums& sums);

  double cell_m() const { return cell_m_; }
  bool empty() const { return tiles_.empty(); }
  /// The cells with values: [west, east) x [south, north).
  struct Extent {
    std::int64_t west = 0, south = 0, east = 0, north = 0;
    std::int64_t columns() const { return east - west; }
    std::int64_t rows() const { return north - south; }
  };
  const Extent& extent() const { return extent_; }
  /// Mean of a cell; NaN for a cell without values.
  double mean(std::int64_t column, std::int64_t row) const;

 private:
  void add(const CellSum& sum);

  static constexpr int tile_bits = 7;
  static constexpr std::int64_t tile_cells = std::int64_t{1} << tile_bits;
  static std::size_t place_in_tile(std::int64_t column, std::int64_t row) {
    return static_cast<std::size_t>((row & (tile_cells - 1)) * tile_cells + (column & (tile_cells - 1)));
  }
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

/// Nodata value of the rasters.
inline constexpr float no_data = -32768;

/// Writes the cells as a Float32 GeoTIFF (deflate, tiled), north up, with no_data in cells without values.
/// The file has the map of the frame (LocalFrame::map). A projected frame has its own CRS, and a tangent
/// frame has the orthographic projection about its origin. A frame without georeference has local metres and
/// no CRS. Throws std::runtime_error with the file's name, also if no cell has a value.
void write_cells(const std::filesystem::path& file, const CellMeans& cells, const LocalFrame& frame,
                 const char* band_name, const char* unit);

}  // namespace tubefoot
