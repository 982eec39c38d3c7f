// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/geometric.hpp>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/echo/volume_regions.hpp"

// Divides the cones of unobstructed water into small cells of directions.

namespace tubefoot {

using Directions = std::vector<glm::dvec3>;

/// A polygon with its own corners.
struct SpacePolygon {
  FacetPlane plane;
  Directions corners_m;

  explicit SpacePolygon(const DoubleSpace::Polygon& view)
      : plane(view.plane), corners_m(view.corners_m.begin(), view.corners_m.end()) {}
};

/// A cell of directions and the polygons in it.
struct WaterCell {
  Directions cone;
  std::vector<SpacePolygon> polygons;
};

/// Returns the unobstructed water of a tube, without layers, as one cell.
inline WaterCell water_cell(const TubeContent<DoubleSpace>& content, VolumeRegions<DoubleSpace>& regions) {
  WaterCell cell{{content.rays.begin(), content.rays.end()}, {}};
  regions.divide(content,
                 [&](const DoubleSpace::Polygon& cone, double) { cell.polygons.emplace_back(cone); });
  return cell;
}

/// Calls take(cell) for the parts of a cell that are at most `width_rad` wide.
template <class Take>
void each_small(WaterCell cell, double width_rad, const Take& take) {
  glm::dvec3 wall(0);
  for (const glm::dvec3& one : cell.cone)
    for (const glm::dvec3& other : cell.cone) {
      const glm::dvec3 apart = glm::normalize(one) - glm::normalize(other);
      if (glm::length(apart) > glm::length(wall)) wall = apart;
    }
  if (glm::length(wall) <= width_rad) return take(cell);
  const auto divided = [&](const Directions& corners) {
    return VolumeRegions<DoubleSpace>::divided(corners,
                                               [&](const glm::dvec3& d) { return glm::dot(wall, d); });
  };
  WaterCell one, other;
  std::tie(one.cone, other.cone) = divided(cell.cone);
  for (const SpacePolygon& polygon : cell.polygons) {
    const auto [inner, outer] = divided(polygon.corners_m);
    if (!inner.empty()) one.polygons.emplace_back(DoubleSpace::Polygon{polygon.plane, inner});
    if (!outer.empty()) other.polygons.emplace_back(DoubleSpace::Polygon{polygon.plane, outer});
  }
  if (!one.polygons.empty()) each_small(std::move(one), width_rad, take);
  if (!other.polygons.empty()) each_small(std::move(other), width_rad, take);
}

}  // namespace tubefoot
