// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

/// The same surface in fewer facets, or nothing where none are merged: where that at least halves them,
/// facets that lie exactly in one plane, face the same way and are of one component and material become the
/// triangles of the polygon that they cover, with as few corners as it has. Nothing is approximated, nothing
/// moves, and the vertices keep their ids. What overlaps others of its plane stays as it is. Law N1 (same
/// surface): what is merged covers the same points of its plane, once, facing the same way;
///   proven for every plane by exact areas: facets that turn one way cover a set once if and only if their
///   areas add up to that of the points they cover an odd number of times.
/// Law N2 (sheet): a mesh without T-junctions stays one: a vertex goes only where the borders of all facets
///   about it run straight through it.
/// Law N3 (order): merged facets stand where the first of them stood, so that those of a component follow one
///   another; threads change nothing.
std::optional<FacetMesh> with_planes_merged(const FacetMesh& mesh);

}  // namespace tubefoot
