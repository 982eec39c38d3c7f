// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/mesh/vertex_normals.hpp"

#include <array>
#include <glm/geometric.hpp>

namespace tubefoot {

glm::dvec3 doubled_area(const FacetMesh& mesh, FacetId facet) {
  std::array<glm::dvec3, 3> v;
  for (std::size_t k = 0; k < 3; ++k) {
    const GridPoint p = mesh.vertices[mesh.facets[facet][k]];
    v[k] = {double(p.x), double(p.y), double(p.z)};
  }
  return glm::cross(v[1] - v[0], v[2] - v[0]);
}

std::vector<glm::dvec3> vertex_normals(const FacetMesh& mesh) {
  std::vector<glm::dvec3> normals(mesh.vertices.size(), glm::dvec3(0));
  for (FacetId f = 0; f < mesh.facets.size(); ++f) {
    const glm::dvec3 n = doubled_area(mesh, f);
    for (const VertexId v : mesh.facets[f]) normals[v] += n;
  }
  for (glm::dvec3& normal : normals) {
    const double length = glm::length(normal);
    normal = length > 0 ? normal / length : glm::dvec3{0, 0, 1};
  }
  return normals;
}

}  // namespace tubefoot
