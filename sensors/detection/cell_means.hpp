// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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

/// What some values put into one cell: the sum of them times their weights, and that of the weights.
struct CellSum {
  std::int64_t column = 0, row = 0;
  double value = 0, weight = 0;
};

/// Such sums of values that come from neighbouring places, before they are added to a grid: on any thread,
/// and fewer than the values. One cell may have several, but together they are at most about twice as many
/// as the cells.
class CellSums {
 public:
  /// Throws std::invalid_argument for a cell that is not positive.
  explicit CellSums(double cell_m);
  /// As CellMeans::add(), of what has room.
  void add(double east_m, double north_m, double value, double weight) {
    const CellSum one = of_one(east_m, north_m, value, weight, cell_m_);
    // Points that follow each other along a border come to few cells in turn.
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
  /// What one value puts into its cell.
  static CellSum of_one(double east_m, double north_m, double value, double weight, double cell_m) {
    constexpr double on_the_border = 1e-6;  // cells
    const double x = east_m / cell_m + on_the_border, y = north_m / cell_m + on_the_border;
    constexpr double farthest = 1e15;  // cells; beyond, neighbouring cells are no longer resolved
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
  /// One sum for each cell, by row and column: rows of samples longer than a few cells come to each again.
  void merge();

  double cell_m_;
  std::size_t merge_at_ = few;
  std::vector<CellSum> sums_;
};

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
  /// Sums of cells of the same size. What memory has no room for is left out, and all after it.
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
  /// Mean of a cell; NaN where no value fell.
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

/// Nodata of the rasters written here.
inline constexpr float no_data = -32768;

/// Writes the cells as a Float32 GeoTIFF (deflate, tiled), north up, no_data where nothing fell, on the map
/// of the frame (LocalFrame::map): a projected frame's own CRS; the orthographic projection about a tangent
/// frame's origin; no CRS but local metres for a frame without georeference. Throws std::runtime_error naming
/// the file, for cells without any value too.
void write_cells(const std::filesystem::path& file, const CellMeans& cells, const LocalFrame& frame,
                 const char* band_name, const char* unit);

}  // namespace tubefoot
