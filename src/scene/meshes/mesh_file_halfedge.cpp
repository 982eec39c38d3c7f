// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef __clang__
// With sanitizers, g++ 12 reports an empty object inside OpenMesh's headers as an uninitialised value.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <limits>

#include "geometry/steps/stop.hpp"
#include "scene/meshes/mesh_file.hpp"

namespace tubefoot {
namespace {

struct BareTraits : OpenMesh::DefaultTraits {
  VertexAttributes(OpenMesh::Attributes::None);
  HalfedgeAttributes(OpenMesh::Attributes::None);
  EdgeAttributes(OpenMesh::Attributes::None);
  FaceAttributes(OpenMesh::Attributes::None);
};

}  // namespace

std::size_t facets_outside_halfedge(const FacetMesh& mesh, FacetId first, FacetId last) {
  ::omerr().disable();  // OpenMesh prints a line for each face that it rejects
  OpenMesh::TriMesh_ArrayKernelT<BareTraits> halfedges;
  std::vector<OpenMesh::VertexHandle> handle(mesh.vertices.size());
  std::size_t refused = 0;
  for (FacetId facet = first; facet < last; ++facet) {
    stop_if_wanted();
    const auto& corners = mesh.facets[facet];
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) {
      ++refused;  // OpenMesh requires different corners
      continue;
    }
    OpenMesh::VertexHandle v[3];
    for (int k = 0; k < 3; ++k) {
      OpenMesh::VertexHandle& known = handle[corners[k]];
      if (!known.is_valid()) known = halfedges.add_vertex({0, 0, 0});
      v[k] = known;
    }
    if (!halfedges.add_face(v[0], v[1], v[2]).is_valid()) ++refused;
  }
  ::omerr().enable();
  return refused;
}

}  // namespace tubefoot
