// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

/// The part of one facet that one tube touches first: the union of convex pieces with disjoint interiors.
/// Metres and radians; positions relative to the apex.
struct Footprint {
  FacetId facet = 0;
  std::uint32_t tube = 0;
  std::uint32_t first_piece = 0, piece_count = 0;        ///< in FootprintSet::pieces
  std::uint32_t first_occluder = 0, occluder_count = 0;  ///< in FootprintSet::occluders
  /// The facet's plane: unit normal that points to the apex's side, and the apex's distance from the plane.
  /// Filled by the visibility code, from the facet's mesh vertices: the pieces may be slivers with no
  /// reliable plane of their own. Read by measure() and by integrate_echo().
  glm::dvec3 plane_normal{0};
  double plane_distance_m = 0;
  // From here on: filled by measure() (measure.hpp) from the plane and the pieces.
  double area_m2 = 0;
  double solid_angle_sr = 0;
  glm::dvec3 centroid_m{0};      ///< centroid of the area, relative to the apex
  double grazing_angle_rad = 0;  ///< at the centroid, between the line of sight and the facet
  double slant_range_min_m = 0, slant_range_max_m = 0;
};

/// A convex polygon on a facet: corners [first, first + count), turning as the rays of its tube do
/// (tube.hpp).
struct Piece {
  std::uint32_t first = 0, count = 0;
};

/// Visible footprints of one ping.
struct FootprintSet {
  std::vector<Footprint> footprints;  ///< ordered by tube, then by facet
  std::vector<Piece> pieces;
  std::vector<glm::dvec3> corners_m;  ///< relative to the apex, metres
  std::vector<FacetId> occluders;     ///< facets that took something away from a footprint
};

}  // namespace tubefoot
