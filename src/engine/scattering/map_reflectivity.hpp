// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <vector>

#include "engine/scattering/reflectivity_field.hpp"

namespace tubefoot {

/// A measured or precomputed map of factors over the plan of the local frame (x, y; independent of z). It is
/// bilinear between the centres of its pixels. A tiled map repeats. Any other map has the value 1 outside,
/// from one pixel beyond its outermost centres on. Values are divided by their mean, so that the mean over
/// the map is 1.
class MapReflectivity : public ReflectivityField {
 public:
  struct Grid {
    std::size_t columns = 0, rows = 0;
    std::vector<float> values;  ///< row by row, not negative; NaN: no data, replaced by the mean
  };
  /// Positions of pixels: the centre of column i, row j is at first + i column + j row.
  struct Placing {
    glm::dvec2 first_m{0}, column_m{1, 0}, row_m{0, 1};
    bool tiled = false;
  };

  /// Throws std::invalid_argument for a map without pixels, for values that are negative, infinite or all 0,
  /// and for pixels without area.
  MapReflectivity(Grid grid, const Placing& placing);

  double factor(glm::dvec3 place_m) const override;
  double largest() const override { return largest_; }
  /// Two pixels, which is the shortest wavelength that such pixels represent.
  double finest_m() const override { return finest_m_; }
  std::span<const CellPlanes> cells() const override { return cells_; }
  double change(double away_m) const override;

  const Grid& grid() const { return grid_; }
  const Placing& placing() const { return placing_; }
  /// Vectors that convert a position minus placing().first_m to columns and rows.
  glm::dvec2 to_column() const { return to_column_; }
  glm::dvec2 to_row() const { return to_row_; }
  /// Returns the value of the pixel at an integer column and row, defined on the whole plane.
  double value(double column, double row) const;

 private:
  Grid grid_;
  Placing placing_;
  glm::dvec2 to_column_{0}, to_row_{0};  ///< convert a position minus first_m to pixels
  double largest_ = 1, finest_m_ = 0;
  double slope_per_m_ = 0, twist_per_m2_ = 0;
  std::array<CellPlanes, 2> cells_;
};

}  // namespace tubefoot
