// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/numbers/int128.hpp"

namespace tubefoot {

/// a - b; both within the grid's coordinate range, so that the result fits 31 bits.
inline GridPoint operator-(GridPoint a, GridPoint b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

/// Vector of 64-bit integers: normals of planes through two points (61 bits) and of facets (62 bits).
struct Vec64 {
  std::int64_t x = 0, y = 0, z = 0;
};

/// Exact for coordinates of 30 bits and sign.
inline Vec64 cross(GridPoint a, GridPoint b) {
  return {std::int64_t(a.y) * b.z - std::int64_t(a.z) * b.y,
          std::int64_t(a.z) * b.x - std::int64_t(a.x) * b.z,
          std::int64_t(a.x) * b.y - std::int64_t(a.y) * b.x};
}

inline Int128 dot(const Vec64& n, GridPoint p) {
  return Int128(n.x) * p.x + Int128(n.y) * p.y + Int128(n.z) * p.z;
}

/// A facet as seen from an apex: vertices relative to it, in the order that makes the determinant of the
/// three positive, so that the facet subtends the cone of directions inside its three edge planes.
/// Law F1 (facing): det(point[0], point[1], point[2]) = offset > 0, and normal and offset are exact.
struct FacetCone {
  FacetId id = 0;
  bool reversed = false;  ///< the order is the reverse of the mesh's
  std::array<VertexId, 3> vertex{};
  std::array<GridPoint, 3> point{};
  Vec64 normal;     ///< of the facet's plane normal . x = offset
  Int128 offset{};  ///< > 0

  /// False if the apex lies in the facet's plane, or the facet has no area: it subtends nothing.
  static bool make(const FacetMesh& mesh, FacetId id, GridPoint apex, FacetCone& cone);
};

/// Order that is independent of facet ids: by sorted vertices, then id. Decides which of two coincident
/// facets is seen, so that reordering the facets of a scene changes nothing.
/// Law F2 (ties): of coincident facets exactly one is seen in a direction; together they show what one would
///   alone.
bool wins_tie(const FacetMesh& mesh, FacetId a, FacetId b);

}  // namespace tubefoot
