// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/map_reflectivity.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

namespace tubefoot {

MapReflectivity::MapReflectivity(Grid grid, const Placing& placing)
    : grid_(std::move(grid)), placing_(placing) {
  if (grid_.columns == 0 || grid_.rows == 0 || grid_.values.size() != grid_.columns * grid_.rows)
    throw std::invalid_argument("the reflectivity map has no pixels");
  const glm::dvec2 c = placing.column_m, r = placing.row_m;
  const double area = c.x * r.y - c.y * r.x;
  if (!(std::abs(area) > 1e-9 * glm::length(c) * glm::length(r) && std::isfinite(area)))
    throw std::invalid_argument("the pixels of the reflectivity map have no area");
  to_column_ = glm::dvec2(r.y, -r.x) / area;
  to_row_ = glm::dvec2(-c.y, c.x) / area;
  finest_m_ = 2 * std::min(1 / glm::length(to_column_), 1 / glm::length(to_row_));

  double sum = 0;
  std::size_t count = 0;
  for (const float value : grid_.values) {
    if (std::isnan(value)) continue;
    if (!(value >= 0 && std::isfinite(value)))
      throw std::invalid_argument("the reflectivity map has negative or infinite values");
    sum += double(value);
    ++count;
  }
  const double mean = count > 0 ? sum / double(count) : 0;
  if (!(mean > 0)) throw std::invalid_argument("the reflectivity map has no value above 0");
  for (float& value : grid_.values) {
    value = std::isnan(value) ? 1.0f : float(double(value) / mean);
    largest_ = std::max(largest_, double(value));
  }

  // Maxima over the cells with a pixel at one corner or more.
  double along_columns = 0, along_rows = 0, twist = 0;
  for (double j = -1; j < double(grid_.rows); ++j)
    for (double i = -1; i < double(grid_.columns); ++i) {
      const double a = value(i, j), b = value(i + 1, j), e = value(i, j + 1), f = value(i + 1, j + 1);
      along_columns = std::max({along_columns, std::abs(b - a), std::abs(f - e)});
      along_rows = std::max({along_rows, std::abs(e - a), std::abs(f - b)});
      twist = std::max(twist, std::abs(f - e - b + a));
    }
  slope_per_m_ = along_columns * glm::length(to_column_) + along_rows * glm::length(to_row_);
  twist_per_m2_ = twist * glm::length(to_column_) * glm::length(to_row_);

  const auto planes = [&](glm::dvec2 across) {
    const double per_m = glm::length(across);
    const glm::dvec2 normal = across / per_m;
    return CellPlanes{{normal, 0}, glm::dot(normal, placing.first_m), 1 / per_m};
  };
  cells_ = {planes(to_column_), planes(to_row_)};
}

double MapReflectivity::value(double column, double row) const {
  const auto columns = double(grid_.columns), rows = double(grid_.rows);
  if (placing_.tiled) {
    column -= columns * std::floor(column / columns);
    row -= rows * std::floor(row / rows);
  }
  if (!(column >= 0 && column < columns && row >= 0 && row < rows)) return 1;
  return double(grid_.values[std::size_t(row) * grid_.columns + std::size_t(column)]);
}

double MapReflectivity::factor(glm::dvec3 place_m) const {
  const glm::dvec2 p = glm::dvec2(place_m) - placing_.first_m;
  const double column = glm::dot(p, to_column_), row = glm::dot(p, to_row_);
  const double i = std::floor(column), j = std::floor(row), x = column - i, y = row - j;
  const double first = (1 - x) * value(i, j) + x * value(i + 1, j);
  const double second = (1 - x) * value(i, j + 1) + x * value(i + 1, j + 1);
  return (1 - y) * first + y * second;
}

double MapReflectivity::change(double away_m) const {
  return away_m * (slope_per_m_ + away_m * twist_per_m2_);
}

}  // namespace tubefoot
