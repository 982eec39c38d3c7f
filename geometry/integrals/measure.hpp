// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/footprints/footprint.hpp"

namespace tubefoot {

/// A facet's plane as the apex sees it. Its foot point, -distance_m * normal, is the plane's nearest point.
struct FacetPlane {
  glm::dvec3 normal{0, 0, 1};  ///< unit, towards the apex's side
  double distance_m = 0;       ///< of the apex, >= 0
};

/// An orthonormal frame of a plane in which pieces turn counter-clockwise: u x v = -normal.
struct PlaneFrame {
  glm::dvec3 u, v;
  explicit PlaneFrame(const FacetPlane& plane);
  glm::dvec2 project(glm::dvec3 p) const;
};

/// A convex polygon in the coordinates of its plane. The corners are kept as offsets from the polygon's own
/// first corner, so that what is computed from them is as accurate for a millimetre at 100 m as for a metre
/// at 1 m.
struct PlanarPolygon {
  double distance = 0;              ///< of the apex from the plane
  glm::dvec2 first{0};              ///< first corner, relative to the foot point
  std::vector<glm::dvec2> offsets;  ///< corners relative to the first corner; offsets[0] is 0

  glm::dvec2 corner(std::size_t i) const { return first + offsets[i]; }
  /// Takes over a piece: corners relative to the apex. Keeps the vector's memory.
  void assign(std::span<const glm::dvec3> corners_m, const FacetPlane& plane, const PlaneFrame& frame);
};

/// Area, positive for a piece that turns as the rays of its tube do.
/// Law M1 (turn): the other turn gives the negative.
double area(const PlanarPolygon& polygon);

/// Centroid of the area, as an offset from the first corner. It stays inside the polygon even for a sliver
/// whose area is lost in rounding; for no area at all it is the mean of the corners.
/// Law M3 (inside): a centroid lies in its polygon, however thin.
glm::dvec2 centroid_offset(const PlanarPolygon& polygon);

/// Solid angle at the apex (Van Oosterom & Strackee 1983, summed over a fan), signed as the area is.
/// The triple product is taken as distance times area, so slivers and grazing facets keep their digits.
/// Law M2 (solid angles add up): the parts of a polygon have together the polygon's.
double solid_angle(const PlanarPolygon& polygon);

/// The polygon's nearest point to the foot point, and so to the apex: a corner, a point of an edge, or the
/// foot.
struct NearestPoint {
  glm::dvec2 offset{0};  ///< from the first corner
  double range = 0;      ///< slant range
};
NearestPoint nearest_point(const PlanarPolygon& polygon);

/// Slant range of the polygon's farthest point, which is a corner.
double farthest_range(const PlanarPolygon& polygon);

/// Fills area, solid angle, centroid, grazing angle and slant ranges of every footprint from its pieces and
/// from its plane, which must have been filled before. A footprint without pieces measures nothing and keeps
/// zeros.
/// Law M4 (accuracy): area and solid angle are those of the exact corners to 1e-12 and the corners' rounding.
void measure(FootprintSet& set);

}  // namespace tubefoot
