// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

namespace tubefoot {

/// Cuts polygons in space into triangles. A polygon is looked at along the axis that it faces most, so that
/// what is decided about it is decided exactly, on its own coordinates; its triangles are those of the
/// constrained Delaunay triangulation of its edges that lie inside. So they have the area of the polygon, do
/// not overlap, and have all of its corners, those on a line with their neighbours too. A ring within may
/// hang on the border by an edge there and back, as writers of OBJ make holes.
class PolygonCutter {
 public:
  using Triangle = std::array<std::uint32_t, 3>;
  enum class Result {
    cut,
    no_area,  ///< all corners on one line: its triangles have no area either
    crossed   ///< it crosses or covers itself: there are no triangles
  };

  PolygonCutter();
  ~PolygonCutter();
  PolygonCutter(const PolygonCutter&) = delete;
  PolygonCutter& operator=(const PolygonCutter&) = delete;

  /// Appends the triangles of a polygon of three corners or more, which turn as it does.
  Result cut(const std::vector<glm::dvec3>& points, std::span<const std::uint32_t> polygon,
             std::vector<Triangle>& triangles);

 private:
  struct Plane;
  std::unique_ptr<Plane> plane_;
};

/// How far a polygon's corners lie from the plane through their middle that has its side, at most; 0 where
/// that is no more than the rounding of single-precision numbers, or a thousandth of its size.
double unevenness(const std::vector<glm::dvec3>& points, std::span<const std::uint32_t> polygon);

}  // namespace tubefoot
