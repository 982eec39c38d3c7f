// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "geometry/integrals/measure.hpp"

namespace tubefoot {

/// Where the points of a facet lie that is seen elsewhere (an apparent facet in refracting water,
/// refracted_surface.hpp): as a point lies between the corners that are seen, so it lies between the true
/// ones.
struct FacetMap {
  glm::dvec3 seen_m{0};  ///< a corner as it is seen, relative to the apex
  glm::dvec3 lies_m{0};  ///< where that corner lies, local frame
  glm::dmat3 linear{1};  ///< of ways on the facet
  glm::dvec3 at(glm::dvec3 from_apex_m) const { return lies_m + linear * (from_apex_m - seen_m); }
};

/// The map that takes three corners to three others; ways across the plane of the seen ones, and all ways
/// where these have no area, come to nothing.
FacetMap facet_map(const glm::dvec3 (&seen_m)[3], const glm::dvec3 (&lies_m)[3]);

/// A facet's plane where it lies in the local frame: the point (x, y) of a PlaneFrame at foot + x u + y v.
struct LyingPlane {
  glm::dvec3 foot_m{0}, u{1, 0, 0}, v{0, 1, 0};
  double stretch = 1;  ///< no way on it is longer than this times the way that is seen

  /// Of a plane that lies where it is seen, from an apex.
  LyingPlane(const FacetPlane& plane, const PlaneFrame& frame, glm::dvec3 apex_m);
  /// Of one that lies elsewhere.
  LyingPlane(const FacetPlane& plane, const PlaneFrame& frame, const FacetMap& map);
  LyingPlane() = default;

  glm::dvec3 at(glm::dvec2 p) const { return foot_m + p.x * u + p.y * v; }
  /// Unit vector, of a plane that is reported relative to an apex.
  glm::dvec3 towards(glm::dvec2 p) const { return glm::normalize(at(p)); }
};

}  // namespace tubefoot
