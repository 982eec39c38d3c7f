// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/mesh/names.hpp"

namespace tubefoot {

/// The mesh, apex and rays to which the names in the result of one tube refer.
struct NameContext {
  const FacetMesh& mesh;
  GridPoint apex;
  const std::vector<GridPoint>& rays;

  GridPoint point(PointId id) const { return id & ray_bit ? rays[id & ~ray_bit] : mesh.vertices[id] - apex; }
};

/// Returns the point where the ray of a corner meets the facet's plane, relative to the apex, in grid units.
/// All values before the last quotient are exact integers, so the relative error of each coordinate is at
/// most 4 units in the last place.
///
/// Law E1 (corner): each coordinate is within 4 units in the last place of the point that the corner's names
/// define.
glm::dvec3 point_on_facet(const NameContext& context, const CornerName& corner, const FacetCone& facet);

/// Returns the direction of a corner's ray, with each component rounded once. The vector is not normalised.
glm::dvec3 direction_of(const NameContext& context, const CornerName& corner);

}  // namespace tubefoot
