// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/scattering/facet_map.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace tubefoot {

FacetMap facet_map(const glm::dvec3 (&seen_m)[3], const glm::dvec3 (&lies_m)[3]) {
  const glm::dvec3 first = seen_m[1] - seen_m[0], second = seen_m[2] - seen_m[0],
                   normal = glm::cross(first, second);
  const double area2 = glm::dot(normal, normal);
  FacetMap map{seen_m[0], lies_m[0], glm::dmat3(0)};
  if (!(area2 > 0)) return map;
  // Vectors that are 1 along one edge and 0 along the other.
  const glm::dvec3 of_first = glm::cross(second, normal) / area2,
                   of_second = glm::cross(normal, first) / area2;
  map.linear = glm::outerProduct(lies_m[1] - lies_m[0], of_first) +
               glm::outerProduct(lies_m[2] - lies_m[0], of_second);
  return map;
}

LyingPlane::LyingPlane(const FacetPlane& plane, const PlaneFrame& frame, glm::dvec3 apex_m)
    : foot_m(apex_m - plane.distance_m * plane.normal), u(frame.u), v(frame.v) {}

LyingPlane::LyingPlane(const FacetPlane& plane, const PlaneFrame& frame, const FacetMap& map)
    : foot_m(map.at(-plane.distance_m * plane.normal)), u(map.linear * frame.u), v(map.linear * frame.v) {
  // The larger eigenvalue of the squared lengths.
  const double uu = glm::dot(u, u), vv = glm::dot(v, v), uv = glm::dot(u, v);
  stretch = std::sqrt((uu + vv + std::hypot(uu - vv, 2 * uv)) / 2);
}

}  // namespace tubefoot
