// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

/// Twice a facet's area times its unit normal, grid units.
glm::dvec3 doubled_area(const FacetMesh& mesh, FacetId facet);

/// By vertex: the mean of the normals of its facets, by area, of length 1. Upwards where they cancel.
std::vector<glm::dvec3> vertex_normals(const FacetMesh& mesh);

}  // namespace tubefoot
