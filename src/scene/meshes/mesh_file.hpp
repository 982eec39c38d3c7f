// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"
#include "scene/description/scene_component.hpp"

namespace tubefoot {

/// What a scene says of a mesh file's axes and units; what it leaves out, the file says.
struct MeshAxes {
  std::optional<std::string> up;  ///< the axis that is up: x | y | z
  std::optional<double> unit_m;
};

/// Facets, and what the file calls the faces that they are of.
struct NamedMesh : ComponentMesh {
  /// Names that go together, the most telling first: of a material, of groups or of a mesh, of an object or a
  /// node. May be empty.
  std::vector<std::vector<std::string>> names;
  std::vector<std::uint32_t> names_of;  ///< by triangle: its names
};

/// Reads a mesh file in metres, z up. OBJ, PLY (ASCII, binary), STL (ASCII, binary) and OFF by their
/// extension; they say nothing of units and axes, so without a word of the scene they are in metres, z up.
/// COLLADA, glTF, 3DS and FBX by their first bytes, through Assimp; where neither file nor scene says what is
/// up or how long a unit is, they are refused.
///
/// Every face takes part, manifold or not; polygons are cut into triangles, faces of less than three corners
/// are counted in a warning. Points that no face uses are left out. Throws InputError with file and, for
/// text, line and column: a file that is empty, cut off, without facets, with coordinates that are not finite
/// or indices that are out of range, with a polygon that crosses itself.
///
/// Why not OpenMesh's readers, or Assimp's for all: tried (OpenMesh 9.0, Assimp 5.2), they pass coordinates
/// through float (7246504.12 m becomes 7246504 m). OpenMesh's drop a vertex that is not a number and so shift
/// all indices after it, and take cut-off files for good ones with faces of uninitialised indices. Its
/// half-edge structure would then refuse faces at complex vertices and edges.
NamedMesh read_mesh_file(const std::filesystem::path& file, const MeshAxes& axes = {});

/// How many of the facets [first, last) OpenMesh's half-edge structure refuses to take, in order of their
/// ids: those at complex vertices or edges, and those with a repeated vertex. For the report only; all of
/// them take part.
std::size_t facets_outside_halfedge(const FacetMesh& mesh, FacetId first, FacetId last);

}  // namespace tubefoot
