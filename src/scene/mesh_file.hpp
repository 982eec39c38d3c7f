// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "geometry/facet_mesh.hpp"
#include "scene/scene_component.hpp"

namespace tubefoot {

/// Reads an OBJ, PLY (ASCII, binary), STL (ASCII, binary) or OFF file, by its extension, in the file's own
/// axes and units. Every face takes part, manifold or not; polygons are cut into triangles. Points that no
/// face uses are left out. Throws InputError with file and, for text, line and column: a file that is empty,
/// cut off, without facets, with coordinates that are not finite or indices that are out of range.
///
/// Why not OpenMesh's readers: tried (9.0), they pass coordinates through float (7246504.12 m becomes 7246504
/// m), drop a vertex that is not a number and so shift all indices after it, and take cut-off files for good
/// ones with faces of uninitialised indices. Its half-edge structure would then refuse faces at complex
/// vertices and edges.
ComponentMesh read_mesh_file(const std::filesystem::path& file);

/// How many of the facets [first, last) OpenMesh's half-edge structure refuses to take, in order of their
/// ids: those at complex vertices or edges, and those with a repeated vertex. For the report only; all of
/// them take part.
std::size_t facets_outside_halfedge(const FacetMesh& mesh, FacetId first, FacetId last);

}  // namespace tubefoot
