// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/numbers/int128.hpp"

namespace tubefoot {

/// Returns a - b. Both are within the grid's coordinate range, so the result fits 31 bits.
inline GridPoint operator-(GridPoint a, GridPoint b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

/// Vector of 64-bit integers, for normals of planes through two points (61 bits) and of facets (62 bits).
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

/// A facet as seen from an apex, with vertices relative to the apex. The order of the vertices makes their
/// determinant positive. The facet then subtends the cone of directions inside its three edge planes.
///
/// Law F1 (facing): det(point[0], point[1], point[2]) = offset > 0, and normal and offset are exact.
struct FacetCone {
  FacetId id = 0;
  bool reversed = false;  ///< whether the order is the reverse of the mesh's order
  std::array<VertexId, 3> vertex{};
  std::array<GridPoint, 3> point{};
  Vec64 normal;     ///< of the facet's plane normal . x = offset
  Int128 offset{};  ///< > 0

  /// Constructs the cone. Returns false if the facet subtends nothing: the apex lies in its plane, or the
  /// facet has no area.
  static bool make(const FacetMesh& mesh, FacetId id, GridPoint apex, FacetCone& cone);
};

/// Compares two coincident facets by sorted vertex positions and then by id. The winner is the visible one,
/// so the order of facets in a scene does not affect the result.
///
/// Law F2 (ties): exactly one of several coincident facets is visible in a direction. Together they show what
/// one of them would show alone.
bool wins_tie(const FacetMesh& mesh, FacetId a, FacetId b);

}  // namespace tubefoot
