// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/footprints/footprint.hpp"

namespace tubefoot {

/// The plane of a facet relative to the apex. The foot point, -distance_m * normal, is the nearest point of
/// the plane.
struct FacetPlane {
  glm::dvec3 normal{0, 0, 1};  ///< unit vector, towards the apex's side
  double distance_m = 0;       ///< of the apex, >= 0
};

/// An orthonormal frame of a plane in which visible polygons turn counter-clockwise: u x v = -normal.
struct PlaneFrame {
  glm::dvec3 u, v;
  explicit PlaneFrame(const FacetPlane& plane);
  glm::dvec2 project(glm::dvec3 p) const;
};

/// A convex polygon in the coordinates of its plane. Corners are offsets from the polygon's own first
/// corner. Results are therefore as accurate for a millimetre at 100 m as for a metre at 1 m.
struct PlanarPolygon {
  double distance = 0;              ///< of the apex from the plane
  glm::dvec2 first{0};              ///< first corner, relative to the foot point
  std::vector<glm::dvec2> offsets;  ///< corners relative to the first corner; offsets[0] is 0

  glm::dvec2 corner(std::size_t i) const { return first + offsets[i]; }
  /// Assigns a visible polygon whose corners are relative to the apex. Keeps the vector's memory.
  void assign(std::span<const glm::dvec3> corners_m, const FacetPlane& plane, const PlaneFrame& frame);
};

/// Area, positive for a polygon with the orientation of its tube's rays.
/// Law M1 (turn): the opposite orientation gives the negative.
double area(const PlanarPolygon& polygon);

/// Centroid of the area, as an offset from the first corner. It stays inside the polygon even for a sliver
/// whose area is lost in rounding. For zero area it is the mean of the corners.
/// Law M3 (inside): a centroid lies in its polygon, however thin.
glm::dvec2 centroid_offset(const PlanarPolygon& polygon);

/// Solid angle at the apex (Van Oosterom & Strackee 1983, summed over a fan), with the sign of the area. The
/// triple product is distance times area, so that slivers and grazing facets keep their digits.
/// Law M2 (solid angles add up): the solid angles of the parts of a polygon add up to that of the polygon.
double solid_angle(const PlanarPolygon& polygon);

/// The point of the polygon nearest to the foot point, and so to the apex: a corner, a point of an edge, or
/// the foot.
struct NearestPoint {
  glm::dvec2 offset{0};  ///< from the first corner
  double range = 0;      ///< slant range
};
NearestPoint nearest_point(const PlanarPolygon& polygon);

/// Slant range of the polygon's farthest point, which is a corner.
double farthest_range(const PlanarPolygon& polygon);

/// Fills area, solid angle, centroid, grazing angle and slant ranges of every footprint. Requires the
/// visible polygons and the plane of each footprint. A footprint without visible polygons keeps zeros.
/// Law M4 (accuracy): area and solid angle are those of the exact corners to 1e-12 and the corners'
/// rounding.
void measure(FootprintSet& set);

}  // namespace tubefoot
