// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/search/line_of_sight.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/mesh/facet_cone.hpp"

namespace tubefoot {

bool in_view(const FacetMesh& mesh, const SceneTree& tree, GridPoint from, GridPoint to, double open_part) {
  const GridPoint d = to - from;
  const double x = d.x, y = d.y, z = d.z;
  // Planes through the line, with both sides of each. Their normals have no rounding errors.
  const std::array<SceneTree::HalfSpace, 6> about{
      {{0, z, -y}, {0, -z, y}, {-z, 0, x}, {z, 0, -x}, {y, -x, 0}, {-y, x, 0}}};
  std::vector<FacetId> near;
  tree.query(from, about, std::nextafter(std::sqrt(x * x + y * y + z * z) * (1 + 1e-12), 1e300), near);
  return std::none_of(near.begin(), near.end(), [&](FacetId facet) {
    FacetCone cone;
    if (!FacetCone::make(mesh, facet, from, cone)) return false;
    for (std::size_t k = 0; k < 3; ++k)
      if (dot(cross(cone.point[k], cone.point[(k + 1) % 3]), d) < 0) return false;
    const Int128 along = dot(cone.normal, d);
    return along > cone.offset &&
           !(open_part > 0 && static_cast<double>(cone.offset) < open_part * static_cast<double>(along));
  });
}

}  // namespace tubefoot
