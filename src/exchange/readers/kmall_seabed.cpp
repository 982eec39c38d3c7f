// SPDX-License-Identifier: GPL-3.0-or-later
#include "exchange/readers/kmall_seabed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

namespace tubefoot {
namespace {

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Least width of the soundings per length, as standard deviations, from which the slope in the direction of
/// the width follows. The heights of a single ping have a common error.
constexpr double least_width = 0.1;

FittedPlane least_squares(const std::vector<glm::dvec3>& points) {
  FittedPlane plane;
  for (const glm::dvec3& p : points) plane.centre_m += p / double(points.size());
  double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
  plane.lo_m = plane.hi_m = points[0];
  for (const glm::dvec3& p : points) {
    const glm::dvec3 d = p - plane.centre_m;
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
    xz += d.x * d.z;
    yz += d.y * d.z;
    plane.lo_m = glm::min(plane.lo_m, glm::dvec2(p));
    plane.hi_m = glm::max(plane.hi_m, glm::dvec2(p));
  }
  const double determinant = xx * yy - xy * xy;
  constexpr double rounding = 1e-10;
  if (!(determinant > rounding * (xx + yy) * (xx + yy)))
    throw std::invalid_argument("the soundings lie on a line, which determines no plane");
  // Slopes along the principal axes of the positions, of which the first is the longer one.
  const double turn = std::atan2(2 * xy, xx - yy) / 2, c = std::cos(turn), n = std::sin(turn);
  const double along = c * c * xx + 2 * c * n * xy + n * n * yy, across = xx + yy - along;
  const double slope = (c * xz + n * yz) / along;
  plane.is_narrow = across < least_width * least_width * along;
  const double cross_slope = plane.is_narrow ? 0 : (c * yz - n * xz) / across;
  plane.slope_east = c * slope - n * cross_slope;
  plane.slope_north = n * slope + c * cross_slope;
  return plane;
}

}  // namespace

FittedPlane fitted_plane(const std::vector<glm::dvec3>& points_m, double most_deviations) {
  constexpr std::size_t least_points = 3;
  constexpr int most_rounds = 50;
  constexpr double deviation_of_median = 1.4826;  // of a normal distribution
  constexpr double least_deviation_m = 1e-6;
  std::vector<glm::dvec3> used = points_m;
  FittedPlane plane;
  for (int round = 0; round < most_rounds; ++round) {
    if (used.size() < least_points)
      throw std::invalid_argument(fmt::format("{} soundings determine no plane", used.size()));
    plane = least_squares(used);
    std::vector<double> residuals;
    for (const glm::dvec3& p : used) residuals.push_back(std::abs(p.z - plane.height_m(p)));
    const double limit_m =
        most_deviations * std::max(least_deviation_m, deviation_of_median * median_of(residuals));
    std::vector<glm::dvec3> next;
    for (const glm::dvec3& p : used)
      if (std::abs(p.z - plane.height_m(p)) <= limit_m) next.push_back(p);
    if (next.size() == used.size()) break;
    used = std::move(next);
  }
  double squares = 0;
  for (const glm::dvec3& p : used) squares += std::pow(p.z - plane.height_m(p), 2);
  plane.rms_m = std::sqrt(squares / double(used.size()));
  plane.used = used.size();
  plane.removed = points_m.size() - used.size();
  return plane;
}

SeabedGrid seabed_grid(const std::vector<glm::dvec3>& points_m, const FittedPlane& plane, double cell_m,
                       double margin_m, double outlier_m) {
  constexpr double most_nodes = 1e6;
  glm::dvec2 lo = plane.lo_m, hi = plane.hi_m;
  for (const glm::dvec3& p : points_m) {
    lo = glm::min(lo, glm::dvec2(p));
    hi = glm::max(hi, glm::dvec2(p));
  }
  lo -= margin_m;
  const glm::dvec2 size = glm::ceil((hi + margin_m - lo) / cell_m) + 1.0;
  if (!(size.x * size.y <= most_nodes))
    throw std::invalid_argument(
        fmt::format("a grid of {:.0f} x {:.0f} nodes is too large: at most {:.0f} nodes are "
                    "supported; increase the cell size",
                    size.x, size.y, most_nodes));
  const auto columns = static_cast<std::size_t>(size.x), rows = static_cast<std::size_t>(size.y);
  constexpr std::size_t block = 4;  // cells per side
  const std::size_t blocks_per_row = columns / block + 1;
  std::vector<std::vector<double>> in_cell(columns * rows), in_block(blocks_per_row * (rows / block + 1));
  const auto cell_of = [&](glm::dvec3 p) {
    const glm::dvec2 at = glm::round((glm::dvec2(p) - lo) / cell_m);
    return std::pair(static_cast<std::size_t>(at.x), static_cast<std::size_t>(at.y));
  };
  for (const glm::dvec3& p : points_m) {
    const auto [column, row] = cell_of(p);
    in_block[row / block * blocks_per_row + column / block].push_back(p.z - plane.height_m(p));
  }
  std::vector<double> median_of_block(in_block.size(), 0);
  for (std::size_t k = 0; k < in_block.size(); ++k)
    if (!in_block[k].empty()) median_of_block[k] = median_of(in_block[k]);
  SeabedGrid grid;
  for (const glm::dvec3& p : points_m) {
    const auto [column, row] = cell_of(p);
    const double residual_m = p.z - plane.height_m(p);
    if (std::abs(residual_m - median_of_block[row / block * blocks_per_row + column / block]) <= outlier_m)
      in_cell[row * columns + column].push_back(residual_m);
    else
      ++grid.removed;
  }
  std::vector<std::optional<double>> residual(in_cell.size());
  double squares = 0, count = 0;
  for (std::size_t k = 0; k < in_cell.size(); ++k) {
    if (in_cell[k].empty()) {
      ++grid.filled;
      continue;
    }
    residual[k] = median_of(in_cell[k]);
    for (const double z : in_cell[k]) squares += std::pow(z - *residual[k], 2);
    count += double(in_cell[k].size());
  }
  grid.rms_m = count > 0 ? std::sqrt(squares / count) : 0;
  // Residuals spread into nodes without soundings, ring by ring.
  constexpr int rings = 8;
  for (int ring = 0; ring < rings; ++ring) {
    const std::vector<std::optional<double>> before = residual;
    for (std::size_t row = 0; row < rows; ++row)
      for (std::size_t column = 0; column < columns; ++column) {
        if (before[row * columns + column]) continue;
        double sum = 0, neighbours = 0;
        for (std::size_t r = row == 0 ? 0 : row - 1; r <= std::min(row + 1, rows - 1); ++r)
          for (std::size_t c = column == 0 ? 0 : column - 1; c <= std::min(column + 1, columns - 1); ++c)
            if (const auto& value = before[r * columns + c]) {
              sum += *value;
              ++neighbours;
            }
        if (neighbours > 0) residual[row * columns + column] = sum / neighbours;
      }
  }
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column) {
      const glm::dvec2 at = lo + cell_m * glm::dvec2(double(column), double(row));
      grid.points_m.emplace_back(at, plane.height_m(at) + residual[row * columns + column].value_or(0));
    }
  for (std::size_t row = 0; row + 1 < rows; ++row)
    for (std::size_t column = 0; column + 1 < columns; ++column) {
      const auto node = static_cast<std::uint32_t>(row * columns + column),
                 above = node + std::uint32_t(columns);
      grid.triangles.push_back({node, node + 1, above + 1});
      grid.triangles.push_back({node, above + 1, above});
    }
  return grid;
}

}  // namespace tubefoot
