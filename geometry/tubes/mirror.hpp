// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <compare>
#include <glm/mat3x3.hpp>
#include <span>
#include <vector>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/mesh/facet_mesh.hpp"

// Planes that reflect, and the parts of a mesh in front of them. See docs/notes/multiple-paths.md.
namespace tubefoot {

/// The plane normal . x = offset of the world grid, with a mirror on the side of its normal. The normal has
/// no common divisor, so two planes are equal if and only if their numbers are.
struct MirrorPlane {
  Vec64 normal;
  Int128 offset{};

  /// Returns the horizontal plane z = `height`, which mirrors everything below.
  static MirrorPlane horizontal(std::int32_t height);
  /// Returns the plane of a facet, which mirrors the side of `seen_from`. This point must not lie in the
  /// plane.
  static MirrorPlane of_facet(const FacetMesh& mesh, FacetId facet, GridPoint seen_from);

  /// Returns the signed distance in units of 1 / |normal|: above 0 in front of the mirror, 0 on it.
  Int128 side(GridPoint p) const { return dot(normal, p) - offset; }
  /// Returns the mirrored point. It is exact if the plane is perpendicular to an axis. Otherwise it is the
  /// nearest grid point (to within 1e-9 units at ties). Throws GridRangeError beyond 31 bits.
  ///
  /// Law I1 (images): the image has the same distance from each point of the plane as the point itself, up to
  /// the grid's rounding.
  GridPoint image(GridPoint p) const;
  glm::dvec3 unit_normal() const;
  /// Returns the matrix that mirrors a direction.
  glm::dmat3 reflection() const;

  friend bool operator==(const MirrorPlane& a, const MirrorPlane& b) {
    return a.normal.x == b.normal.x && a.normal.y == b.normal.y && a.normal.z == b.normal.z &&
           a.offset == b.offset;
  }
  friend bool operator<(const MirrorPlane& a, const MirrorPlane& b);
};

/// Vertex of a part of a mesh. It is the point at which the mirror plane cuts the line between two vertices
/// of the whole mesh. If both are equal, it is this vertex.
struct PartVertex {
  VertexId from = 0, to = 0;
  friend auto operator<=>(const PartVertex&, const PartVertex&) = default;
};

/// A mesh of some facets of another mesh, or of parts of them.
struct MeshPart {
  FacetMesh mesh;
  std::vector<FacetId> origin;       ///< per facet: the facet that it is, or of which it is a part
  std::vector<PartVertex> vertex{};  ///< per vertex, if requested
};

/// A corner of a part of a facet: the position at the fraction `part` from one of the facet's corners to
/// another.
struct PartCorner {
  std::size_t from = 0, to = 0;
  long double part = 0;
};

/// Returns the parts of the facets (sorted) that lie in front of the plane. Facets that the plane cuts end
/// there, with corners rounded to the grid. Parts in the plane or behind it are omitted. Facets keep their
/// order. `corners`, if not null, receives the positions of each facet's corners on its original facet,
/// before rounding. With `named`, the result has MeshPart::vertex, and two vertices of the mesh stay two even
/// at the same place.
///
/// Law I2 (front): the result contains everything in front of the plane and nothing behind it, up to this
/// rounding.
MeshPart in_front_of(const MirrorPlane& plane, const FacetMesh& mesh, std::span<const FacetId> facets,
                     std::vector<std::array<PartCorner, 3>>* corners = nullptr, bool named = false);

}  // namespace tubefoot
