// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/mesh/names.hpp"

namespace tubefoot {

/// The part of one facet that one tube meets first: a union of convex pieces with disjoint interiors. Units
/// are metres and radians; positions are relative to the apex.
struct Footprint {
  FacetId facet = 0;
  std::uint32_t tube = 0;
  std::uint32_t first_piece = 0, piece_count = 0;        ///< range in FootprintSet::pieces
  std::uint32_t first_occluder = 0, occluder_count = 0;  ///< range in FootprintSet::occluders
  /// The facet's plane: the unit normal that points to the apex's side, and the distance of the apex from the
  /// plane. The visibility code computes both from the mesh vertices, because the plane of a sliver piece is
  /// not reliable. measure() and integrate_echo() read them.
  glm::dvec3 plane_normal{0};
  double plane_distance_m = 0;
  // measure() (measure.hpp) computes the following members from the plane and the pieces.
  double area_m2 = 0;
  double solid_angle_sr = 0;
  glm::dvec3 centroid_m{0};      ///< centroid of the area, relative to the apex
  double grazing_angle_rad = 0;  ///< at the centroid, between the line of sight and the facet
  double slant_range_min_m = 0, slant_range_max_m = 0;
};

/// A convex polygon on a facet: corners [first, first + count), in the sense of rotation of the rays of its
/// tube (tube.hpp).
struct Piece {
  std::uint32_t first = 0, count = 0;
};

/// Convex cone of directions in which a tube meets no facet. Its corners are [first, first + count) of
/// FootprintSet::open_directions, in the sense of rotation of the tube's rays.
struct OpenPiece {
  std::uint32_t tube = 0;
  std::uint32_t first = 0, count = 0;
};

/// The footprints of one ping.
struct FootprintSet {
  std::vector<Footprint> footprints;  ///< ordered by tube, then by facet
  std::vector<Piece> pieces;
  std::vector<glm::dvec3> corners_m;  ///< relative to the apex, metres
  std::vector<FacetId> occluders;     ///< facets that hide a part of a footprint
  /// The names of `corners_m`, in the same order. Empty unless VisibilityOptions::corner_names is set.
  std::vector<CornerName> corner_names{};
  /// The rays to which these names refer: ray r is name_rays[r & ~ray_bit]. The rays of each tube follow
  /// those of the previous one.
  std::vector<GridPoint> name_rays{};
  /// The unobstructed region of each tube: convex cones with disjoint interiors, ordered by tube. Empty
  /// unless VisibilityOptions::open_water is set.
  std::vector<OpenPiece> open_pieces{};
  std::vector<glm::dvec3> open_directions{};  ///< unit vectors
};

}  // namespace tubefoot
