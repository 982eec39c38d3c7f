// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/facet_cone.hpp"

#include <algorithm>

namespace tubefoot {

bool FacetCone::make(const FacetMesh& mesh, FacetId id, GridPoint apex, FacetCone& cone) {
  cone.id = id;
  cone.vertex = mesh.facets[id];
  for (int k = 0; k < 3; ++k) cone.point[k] = mesh.vertices[cone.vertex[k]] - apex;
  // The sum of the three edge normals is twice the projected areas of the facet and has 62 bits. Partial sums
  // may overflow; unsigned arithmetic makes the wrap-around defined.
  const Vec64 ab = cross(cone.point[0], cone.point[1]), bc = cross(cone.point[1], cone.point[2]),
              ca = cross(cone.point[2], cone.point[0]);
  const auto sum = [](std::int64_t p, std::int64_t q, std::int64_t r) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(p) + static_cast<std::uint64_t>(q) +
                                     static_cast<std::uint64_t>(r));
  };
  cone.normal = {sum(ab.x, bc.x, ca.x), sum(ab.y, bc.y, ca.y), sum(ab.z, bc.z, ca.z)};
  cone.offset = dot(cone.normal, cone.point[0]);
  if (cone.offset == 0) return false;
  cone.reversed = cone.offset < 0;
  if (cone.reversed) {
    std::swap(cone.vertex[1], cone.vertex[2]);
    std::swap(cone.point[1], cone.point[2]);
    cone.normal = {-cone.normal.x, -cone.normal.y, -cone.normal.z};
    cone.offset = -cone.offset;
  }
  return true;
}

bool wins_tie(const FacetMesh& mesh, FacetId a, FacetId b) {
  const auto key = [&](FacetId f) {
    std::array<GridPoint, 3> k;
    for (int i = 0; i < 3; ++i) k[i] = mesh.vertices[mesh.facets[f][i]];
    std::sort(k.begin(), k.end());
    return k;
  };
  const auto ka = key(a), kb = key(b);
  if (ka != kb) return ka < kb;
  return a < b;
}

}  // namespace tubefoot
