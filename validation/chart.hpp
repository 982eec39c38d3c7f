// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Exact_rational.h>

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <span>
#include <vector>

#include "geometry/arithmetic/exact_corner.hpp"
#include "geometry/numbers/exact_vector.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot::atlas {

/// Section of one tube with coordinates (u, v), with direction = ray 0 + u (ray 3 - ray 0) + v (ray 1 - ray
/// 0). The tube is the unit square. An area in it is the area in the gnomonic plane divided by that of the
/// tube.
class Chart {
 public:
  /// Throws std::invalid_argument if the tube is not a parallelogram.
  Chart(const TubeSet& tubes, std::uint32_t tube);

  glm::dvec3 direction(glm::dvec2 uv) const;

  struct Polygon {
    FacetId facet = 0;
    std::vector<glm::dvec2> corners;  ///< exact, then rounded once
    CGAL::Exact_rational area;        ///< signed: positive for the orientation of the tube
  };
  /// Evaluates the names of a piece. Returns false if they do not describe a cone in front of the apex.
  bool polygon(const NameContext& context, const TubeVisibility& seen, const NamedPiece& piece,
               Polygon& result) const;

 private:
  std::array<GridPoint, 3> frame_;  ///< ray 0, and the directions of u and v
  std::array<ExactVector, 3> dual_;
};

/// Special values of facet numbers at sample points.
constexpr FacetId nothing_there = 0xffffffffu, several_there = 0xfffffffeu;

/// Returns the facet whose polygon covers each point. Points are ordered by the cells of an n x n grid (row
/// by row, v upwards), one inside each cell.
std::vector<FacetId> locate(std::span<const Chart::Polygon> polygons, std::span<const glm::dvec2> points,
                            std::uint32_t n);

}  // namespace tubefoot::atlas
