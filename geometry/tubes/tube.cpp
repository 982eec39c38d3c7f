// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/tubes/tube.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>

#include "geometry/numbers/int128.hpp"
#include "geometry/numbers/scalars.hpp"

// Constructs the tubes of an angular grid from integer rays. Exact determinants check that every cell is a
// strictly convex pyramid after the rays are rounded.

namespace tubefoot {
namespace {

/// An enclosing pyramid does not extend farther from its axis than this tangent.
constexpr double widest_pyramid = 1;
/// Margin of an enclosing pyramid around its tubes: far larger than the rounding of rays, which is 1e-9.
constexpr double pyramid_margin = 1e-7;

/// Returns the sign of det(a, b, c), exactly: |coordinate| <= 2^30 makes each of the six products at most
/// 2^90.
int orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  const Int128 nx = Int128(a.y) * b.z - Int128(a.z) * b.y;
  const Int128 ny = Int128(a.z) * b.x - Int128(a.x) * b.z;
  const Int128 nz = Int128(a.x) * b.y - Int128(a.y) * b.x;
  const Int128 det = nx * c.x + ny * c.y + nz * c.z;
  return det > 0 ? 1 : det < 0 ? -1 : 0;
}

/// Returns the common sign of all walls for all rays that are not on them. The sign is +1 if the four rays
/// turn counter-clockwise about a convex pyramid and -1 if clockwise. It is 0 if they form no strictly convex
/// pyramid.
int winding(const std::vector<GridPoint>& rays, const Tube& tube) {
  int common = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const GridPoint& a = rays[tube[k]];
    const GridPoint& b = rays[tube[(k + 1) % 4]];
    for (std::size_t other = 2; other < 4; ++other) {
      const int sign = orientation(a, b, rays[tube[(k + other) % 4]]);
      if (sign == 0 || (common != 0 && sign != common)) return 0;
      common = sign;
    }
  }
  return common;
}

void check_edges(const std::vector<double>& edges_rad, const char* angle) {
  if (edges_rad.size() < 2)
    throw std::invalid_argument(
        fmt::format("a tube grid needs at least two {} edges, not {}", angle, edges_rad.size()));
  for (std::size_t k = 0; k < edges_rad.size(); ++k) {
    if (!std::isfinite(edges_rad[k]))
      throw std::invalid_argument(fmt::format("{} edge {} of a tube grid is not finite", angle, k));
    if (k > 0 && !(edges_rad[k] > edges_rad[k - 1]))
      throw std::invalid_argument(
          fmt::format("{} edges of a tube grid must increase: edge {} is {} rad, edge {} is {} rad", angle,
                      k - 1, edges_rad[k - 1], k, edges_rad[k]));
  }
}

void check_grid(const AngularGrid& grid) {
  check_edges(grid.azimuth_edges_rad, "azimuth");
  check_edges(grid.elevation_edges_rad, "elevation");
  const auto& azimuth = grid.azimuth_edges_rad;
  for (std::size_t k = 1; k < azimuth.size(); ++k)
    if (azimuth[k] - azimuth[k - 1] >= pi)
      throw std::invalid_argument(
          fmt::format("azimuth cell {} of a tube grid spans {} rad: a tube must span less than pi", k - 1,
                      azimuth[k] - azimuth[k - 1]));
  // The limit permits a few roundings of 2 pi, because edges are often sums of steps.
  if (azimuth.back() - azimuth.front() > 2 * pi + 1e-12)
    throw std::invalid_argument(
        fmt::format("a tube grid spans {} rad in azimuth: above 2 pi, its tubes would overlap",
                    azimuth.back() - azimuth.front()));
  if (grid.elevation_edges_rad.front() <= -pi / 2 || grid.elevation_edges_rad.back() >= pi / 2)
    throw std::invalid_argument(
        fmt::format("elevation edges of a tube grid must lie inside (-pi/2, pi/2), not [{}, {}] rad",
                    grid.elevation_edges_rad.front(), grid.elevation_edges_rad.back()));
}

}  // namespace

glm::dvec3 direction(const AngularGrid& grid, double azimuth_rad, double elevation_rad) {
  const double horizontal = std::cos(elevation_rad);
  return grid.frame[0] * (std::cos(azimuth_rad) * horizontal) +
         grid.frame[1] * (std::sin(azimuth_rad) * horizontal) + grid.frame[2] * std::sin(elevation_rad);
}

GridPoint integer_ray(glm::dvec3 unit_direction) {
  constexpr double scale = (1 << 30) - 1;
  // The coordinate of a unit vector may exceed 1 by a rounding error, but never by enough to exceed 2^30.
  const auto rounded = [](double coordinate) {
    return static_cast<std::int32_t>(std::llround(coordinate * scale));
  };
  return {rounded(unit_direction.x), rounded(unit_direction.y), rounded(unit_direction.z)};
}

std::uint32_t append_tubes(TubeSet& set, const AngularGrid& grid) {
  check_grid(grid);
  const auto& azimuth = grid.azimuth_edges_rad;
  const auto& elevation = grid.elevation_edges_rad;
  // A grid that closes on itself reuses its first column of rays, so that it has no seam.
  const bool closed = azimuth.back() - azimuth.front() > 2 * pi - 1e-12;
  const std::size_t columns = azimuth.size() - (closed ? 1 : 0);
  const std::size_t rows = elevation.size();

  std::vector<GridPoint> rays;
  rays.reserve(columns * rows);
  for (std::size_t i = 0; i < columns; ++i)
    for (const double angle_rad : elevation)
      rays.push_back(integer_ray(direction(grid, azimuth[i], angle_rad)));

  const auto ray = [&](std::size_t i, std::size_t j) {
    return static_cast<std::uint32_t>((i % columns) * rows + j);
  };
  std::vector<Tube> tubes;
  tubes.reserve((azimuth.size() - 1) * (rows - 1));
  for (std::size_t i = 0; i + 1 < azimuth.size(); ++i) {
    for (std::size_t j = 0; j + 1 < rows; ++j) {
      Tube tube{ray(i, j), ray(i + 1, j), ray(i + 1, j + 1), ray(i, j + 1)};
      const int turn = winding(rays, tube);
      if (turn == 0)
        throw std::invalid_argument(
            fmt::format("tube grid cell (azimuth {}, elevation {}) degenerates when its rays are rounded to "
                        "2^-30: it spans {} x {} rad and is too narrow or too close to the axis",
                        i, j, azimuth[i + 1] - azimuth[i], elevation[j + 1] - elevation[j]));
      if (turn < 0) std::swap(tube[1], tube[3]);
      tubes.push_back(tube);
    }
  }

  // Only a whole grid is appended. An exception above leaves `set` unchanged.
  const auto first_ray = static_cast<std::uint32_t>(set.rays.size());
  const auto first_tube = static_cast<std::uint32_t>(set.tubes.size());
  set.rays.insert(set.rays.end(), rays.begin(), rays.end());
  for (Tube& tube : tubes)
    for (std::uint32_t& corner : tube) corner += first_ray;
  set.tubes.insert(set.tubes.end(), tubes.begin(), tubes.end());
  return first_tube;
}

std::optional<std::array<GridPoint, 4>> enclosing_pyramid(const TubeSet& set, std::uint32_t first,
                                                          std::uint32_t end) {
  const auto unit = [&](std::uint32_t ray) {
    const GridPoint& d = set.rays[ray];
    return glm::normalize(glm::dvec3(d.x, d.y, d.z));
  };
  const auto middle = [&](const Tube& tube) {
    glm::dvec3 sum{0};
    for (const std::uint32_t ray : tube) sum += unit(ray);
    return glm::normalize(sum);
  };
  glm::dvec3 sum{0};
  for (std::uint32_t tube = first; tube < end; ++tube) sum += middle(set.tubes[tube]);
  if (glm::length(sum) < 0.1 * (end - first)) return std::nullopt;
  const glm::dvec3 axis = glm::normalize(sum);
  glm::dvec3 along = middle(set.tubes[end - 1]) - middle(set.tubes[first]);
  along -= axis * glm::dot(axis, along);
  if (glm::length(along) < pyramid_margin) return std::nullopt;
  along = glm::normalize(along);
  const glm::dvec3 across = glm::cross(axis, along);

  constexpr double infinity = std::numeric_limits<double>::infinity();
  glm::dvec2 low(infinity), high(-infinity);
  for (std::uint32_t tube = first; tube < end; ++tube)
    for (const std::uint32_t ray : set.tubes[tube]) {
      const glm::dvec3 d = unit(ray);
      const double depth = glm::dot(d, axis);
      const glm::dvec2 p(glm::dot(d, along), glm::dot(d, across));
      if (depth <= 0 || std::max(std::abs(p.x), std::abs(p.y)) > widest_pyramid * depth) return std::nullopt;
      low = glm::min(low, p / depth);
      high = glm::max(high, p / depth);
    }
  low -= pyramid_margin;
  high += pyramid_margin;
  const auto corner = [&](double x, double y) {
    return integer_ray(glm::normalize(axis + x * along + y * across));
  };
  // (axis, along, across) is right-handed, so these corners turn as the rays of a tube do.
  const std::array<GridPoint, 4> rays{corner(low.x, low.y), corner(high.x, low.y), corner(high.x, high.y),
                                      corner(low.x, high.y)};
  for (std::uint32_t tube = first; tube < end; ++tube)
    for (const std::uint32_t ray : set.tubes[tube])
      for (std::size_t k = 0; k < 4; ++k)
        if (orientation(rays[k], rays[(k + 1) % 4], set.rays[ray]) <= 0) return std::nullopt;
  return rays;
}

}  // namespace tubefoot
