// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "geometry/integrals/measure.hpp"

namespace tubefoot {

/// Affine map from the apparent positions of a facet's points to their true positions (an apparent facet in
/// stratified water, refracted_surface.hpp). A point lies between the true corners as it lies between the
/// apparent ones.
struct FacetMap {
  glm::dvec3 seen_m{0};  ///< apparent position of a corner, relative to the apex
  glm::dvec3 lies_m{0};  ///< true position of that corner, local frame
  glm::dmat3 linear{1};  ///< for vectors on the facet
  glm::dvec3 at(glm::dvec3 from_apex_m) const { return lies_m + linear * (from_apex_m - seen_m); }
};

/// Returns the map of three corners to three others. It maps vectors normal to the apparent plane to zero. If
/// the apparent corners have no area, it maps all vectors to zero.
FacetMap facet_map(const glm::dvec3 (&seen_m)[3], const glm::dvec3 (&lies_m)[3]);

/// A facet's plane at its true position in the local frame. The point (x, y) of a PlaneFrame is at foot + x u
/// + y v.
struct LyingPlane {
  glm::dvec3 foot_m{0}, u{1, 0, 0}, v{0, 1, 0};
  double stretch = 1;  ///< upper bound of the ratio of true to apparent lengths

  /// Constructs the plane for an apparent position that equals the true one, seen from an apex.
  LyingPlane(const FacetPlane& plane, const PlaneFrame& frame, glm::dvec3 apex_m);
  /// Constructs the plane for another true position.
  LyingPlane(const FacetPlane& plane, const PlaneFrame& frame, const FacetMap& map);
  LyingPlane() = default;

  glm::dvec3 at(glm::dvec2 p) const { return foot_m + p.x * u + p.y * v; }
  /// Returns a unit vector to the point, for a plane whose positions are relative to an apex.
  glm::dvec3 towards(glm::dvec2 p) const { return glm::normalize(at(p)); }
};

}  // namespace tubefoot
