// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

/// The visible parts of a mesh from infinite distance, along parallel lines.
///
/// Tubes have an apex. A projective map therefore takes the point at infinity of the line of sight to an apex
/// at four radii of the bounding sphere. Lines and planes remain lines and planes, and the order along lines
/// of sight is unchanged. The mapped vertices are rounded to a grid; all further computations are exact, and
/// corners are mapped back. The result is therefore the exact view of a mesh whose vertices are displaced by
/// at most `vertex_error` of the radius. It has no perspective. A real apex within the limits of the grid
/// would be only some hundred metres away.
struct FarView {
  /// Bound of a vertex's displacement relative to the radius of the bounding sphere. It is half a unit of
  /// 2^-27 along each axis, enlarged by the inverse map by at most 16/9.
  static constexpr double vertex_error = 1.2e-8;

  /// A convex part of a facet, corners [first, first + count).
  struct Part {
    FacetId facet = 0;
    std::uint32_t first = 0, count = 0;
  };
  std::vector<Part> parts;  ///< with disjoint interiors, ordered by tube and facet
  /// Corners in the plane perpendicular to the line of sight, relative to the projection of the mesh's
  /// origin; counter-clockwise for the viewer.
  std::vector<glm::dvec2> across_m;
  std::vector<double> towards_m;  ///< per corner: distance from the origin towards the viewer

  /// Returns the area of all parts together, which is that of the mesh's silhouette.
  double area_m2() const;
};

/// The mesh of which a view is the exact one, and its corners before they are mapped back. Error bounds of a
/// view need these data. Lengths are in radii of the bounding sphere, and the apex is at (0, 0, apex_height).
/// A mapped position m corresponds to middle + radius m / (1 - m.z / apex_height), in the axes right, up and
/// towards the viewer.
struct FarViewGrid {
  static constexpr double apex_height = 4;
  static constexpr int exponent = 27;  ///< of the unit, 2^-exponent radii

  glm::dvec3 middle_m{0};
  double radius_m = 0;
  glm::dvec3 upwards{0};            ///< right is its cross product with the line of sight
  std::vector<GridPoint> vertices;  ///< mapped points of the mesh, in units from the middle
  /// The corners of FarView, mapped and relative to the apex. Each coordinate is within 4 units in the last
  /// place (law E1).
  std::vector<glm::dvec3> corners;
};

/// Computes the view. `towards` is the unit vector from the mesh to the viewer. Throws std::invalid_argument
/// for points that are not finite or all the same. Facets are visible from either side. `grid`, if not null,
/// receives the mesh of which the view is exact.
///
/// Law O5 (far view): the areas of the parts add up to the area of the silhouette.
FarView far_view(std::span<const glm::dvec3> points_m,
                 std::span<const std::array<std::uint32_t, 3>> triangles, glm::dvec3 towards,
                 FarViewGrid* grid = nullptr);

}  // namespace tubefoot
