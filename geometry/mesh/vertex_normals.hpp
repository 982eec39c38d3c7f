// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

/// Returns twice a facet's area times its unit normal, in grid units.
glm::dvec3 doubled_area(const FacetMesh& mesh, FacetId facet);

/// Returns, per vertex, the area-weighted mean of the normals of its facets, with length 1. The normal is
/// upwards if the sum is zero.
std::vector<glm::dvec3> vertex_normals(const FacetMesh& mesh);

}  // namespace tubefoot
