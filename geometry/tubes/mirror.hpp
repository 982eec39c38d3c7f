// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/mat3x3.hpp>
#include <span>
#include <vector>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/mesh/facet_mesh.hpp"

// Planes that reflect, and what of a mesh lies in front of them. docs/paths.md
namespace tubefoot {

/// The plane normal . x = offset of the world grid, with a mirror on the side that its normal points to. The
/// normal has no common divisor, so that planes are the same exactly if their numbers are.
struct MirrorPlane {
  Vec64 normal;
  Int128 offset{};

  /// The horizontal plane z = `height`, mirroring what is below.
  static MirrorPlane horizontal(std::int32_t height);
  /// The plane of a facet, mirroring the side of `seen_from`, which must not lie in it.
  static MirrorPlane of_facet(const FacetMesh& mesh, FacetId facet, GridPoint seen_from);

  /// Above 0 in front of the mirror, 0 on it: the distance in units of 1 / |normal|.
  Int128 side(GridPoint p) const { return dot(normal, p) - offset; }
  /// The mirrored point: exact where the plane is perpendicular to an axis, else the nearest grid point (to
  /// within 1e-9 units of half way). Throws GridRangeError beyond 31 bits.
  /// Law I1 (images): as far from each point of the plane as the point itself, to within the grid's rounding.
  GridPoint image(GridPoint p) const;
  glm::dvec3 unit_normal() const;
  /// Mirrors a direction.
  glm::dmat3 reflection() const;

  friend bool operator==(const MirrorPlane& a, const MirrorPlane& b) {
    return a.normal.x == b.normal.x && a.normal.y == b.normal.y && a.normal.z == b.normal.z &&
           a.offset == b.offset;
  }
  friend bool operator<(const MirrorPlane& a, const MirrorPlane& b);
};

/// Some facets of a mesh, or parts of them, as a mesh.
struct MeshPart {
  FacetMesh mesh;
  std::vector<FacetId> origin;  ///< by facet: the one that it is, or is a part of
};

/// A corner of a part of a facet: so much of the way from one of the facet's corners to another.
struct PartCorner {
  std::size_t from = 0, to = 0;
  long double part = 0;
};

/// What of the facets (sorted) lies in front of the plane: facets that the plane cuts end there, in corners
/// rounded to the grid; what lies in the plane or behind it is left out. Facets keep their order. `corners`,
/// if given, gets where the corners of each facet lie on the one that it is a part of, before they are
/// rounded. Law I2 (front): nothing behind the plane is left and nothing before it lost, to within that
/// rounding.
MeshPart in_front_of(const MirrorPlane& plane, const FacetMesh& mesh, std::span<const FacetId> facets,
                     std::vector<std::array<PartCorner, 3>>* corners = nullptr);

}  // namespace tubefoot
