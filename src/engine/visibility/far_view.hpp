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

/// What of a mesh is seen from infinitely far away, along parallel lines.
///
/// Tubes end in an apex, so the mesh goes through the projective map that takes the point at infinity of the
/// line of sight to an apex at four radii of the bounding sphere: lines stay lines, planes stay planes, and
/// what hides what stays. Vertices are then put on a grid; all else is exact, and corners are mapped back. So
/// this is the exact view of a mesh whose vertices are off by at most `vertex_error` of the radius, and there
/// is no perspective in it: a real apex that the grid allows would be some hundred metres away.
struct FarView {
  /// Bound of a vertex's displacement over the radius of the bounding sphere: half a unit of 2^-27 along each
  /// axis, stretched by the map back by no more than 16/9.
  static constexpr double vertex_error = 1.2e-8;

  /// A convex part of a facet, corners [first, first + count).
  struct Part {
    FacetId facet = 0;
    std::uint32_t first = 0, count = 0;
  };
  std::vector<Part> parts;  ///< of disjoint interiors, by tube and facet
  /// Corners in the plane across the line of sight, from the foot of the mesh's origin: counter-clockwise for
  /// the viewer.
  std::vector<glm::dvec2> across_m;
  std::vector<double> towards_m;  ///< by corner: how far it lies towards the viewer from the origin

  /// Of all parts together: the mesh's silhouette.
  double area_m2() const;
};

/// The mesh that a view is the exact one of, and its corners before they were mapped back: what a bound of
/// what a view tells is made of. Lengths in radii of the bounding sphere, apex at (0, 0, apex_height): a
/// mapped place m stands for middle + radius m / (1 - m.z / apex_height), in the axes right, up and towards
/// the viewer.
struct FarViewGrid {
  static constexpr double apex_height = 4;
  static constexpr int exponent = 27;  ///< of the unit, 2^-exponent radii

  glm::dvec3 middle_m{0};
  double radius_m = 0;
  glm::dvec3 upwards{0};            ///< right is its cross product with the line of sight
  std::vector<GridPoint> vertices;  ///< of the mesh's points, mapped, in units from the middle
  /// As FarView's, mapped and from the apex: each coordinate within 4 units in the last place (law E1).
  std::vector<glm::dvec3> corners;
};

/// `towards`: unit, from the mesh to the viewer. Throws std::invalid_argument for points that are not finite
/// or all the same. Facets are seen from either side. `grid`, if given, receives what the view is exact of.
/// Law O5 (far view): parts of the view have together the area of the silhouette.
FarView far_view(std::span<const glm::dvec3> points_m,
                 std::span<const std::array<std::uint32_t, 3>> triangles, glm::dvec3 towards,
                 FarViewGrid* grid = nullptr);

}  // namespace tubefoot
