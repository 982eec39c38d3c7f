// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

namespace tubefoot {

/// Divides polygons in space into triangles. The polygon is projected along the coordinate axis closest to
/// its normal, so that all decisions are exact on its own coordinates.
/// The triangles are those of the constrained Delaunay triangulation of its edges that lie inside. They
/// have the area of the polygon, do not overlap, and contain all corners, including collinear ones.
/// An inner ring may be connected to the border by an edge in both directions, as writers of OBJ create
/// holes.
class PolygonCutter {
 public:
  using Triangle = std::array<std::uint32_t, 3>;
  enum class Result {
    cut,
    no_area,  ///< all corners are collinear, so that the triangles have no area either
    crossed   ///< the polygon intersects or covers itself; there are no triangles
  };

  PolygonCutter();
  ~PolygonCutter();
  PolygonCutter(const PolygonCutter&) = delete;
  PolygonCutter& operator=(const PolygonCutter&) = delete;

  /// Appends the triangles of a polygon with at least three corners. The triangles have the orientation of
  /// the polygon.
  Result cut(const std::vector<glm::dvec3>& points, std::span<const std::uint32_t> polygon,
             std::vector<Triangle>& triangles);

 private:
  struct Plane;
  std::unique_ptr<Plane> plane_;
};

/// Returns the largest distance of a polygon's corners from the plane through their centre with the
/// polygon's normal. It is 0 if the distance does not exceed the rounding of single-precision numbers, or a
/// thousandth of the polygon's size.
double unevenness(const std::vector<glm::dvec3>& points, std::span<const std::uint32_t> polygon);

}  // namespace tubefoot
