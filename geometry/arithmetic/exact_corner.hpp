// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/mesh/names.hpp"

namespace tubefoot {

/// What the names of one tube's result refer to.
struct NameContext {
  const FacetMesh& mesh;
  GridPoint apex;
  const std::vector<GridPoint>& rays;

  GridPoint point(PointId id) const { return id & ray_bit ? rays[id & ~ray_bit] : mesh.vertices[id] - apex; }
};

/// The point where the ray of a corner meets the facet's plane, relative to the apex, in grid units.
/// Everything is an exact integer until the last quotient: relative error of each coordinate at most 4 units
/// in the last place.
/// Law E1 (corner): each coordinate is within 4 units in the last place of what the corner's names stand for.
glm::dvec3 point_on_facet(const NameContext& context, const CornerName& corner, const FacetCone& facet);

/// Direction of a corner's ray, each component rounded once; of any length.
glm::dvec3 direction_of(const NameContext& context, const CornerName& corner);

}  // namespace tubefoot
