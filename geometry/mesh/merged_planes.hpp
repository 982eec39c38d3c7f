// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

/// Merges coplanar facets, or returns nothing if none can be merged. Facets are merged if they lie exactly in
/// one plane, face the same way and have one component and material. They become the triangles of the polygon
/// that they cover, with as few corners as the polygon has. This is done only if it at least halves their
/// number. The surface does not change, and vertices keep their ids. Facets that overlap others of their
/// plane stay unchanged.
///
/// Law N1 (same surface): merged facets cover the same points of their plane, once, facing the same way.
/// Exact areas prove this for every plane: facets of one orientation cover a set once if and only if the sum
/// of their areas equals the area of the points that they cover an odd number of times.
///
/// Law N2 (sheet): a mesh without T-junctions stays without T-junctions. A vertex is removed only if the
/// borders of all facets around it run straight through it.
///
/// Law N3 (order): merged facets take the position of the first of them, so that the facets of a component
/// stay contiguous. The number of threads does not affect the result.
std::optional<FacetMesh> with_planes_merged(const FacetMesh& mesh);

}  // namespace tubefoot
