// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"
#include "scene/description/scene_component.hpp"

namespace tubefoot {

/// The axes and units of a mesh file in the scene. Missing values follow from the file.
struct MeshAxes {
  std::optional<std::string> up;  ///< axis that is up: x | y | z
  std::optional<double> unit_m;
  // For files that do not state them:
  std::optional<std::string> up_unless_stated{};
  std::optional<double> unit_unless_stated_m{};
};

/// Facets, and the names of their faces in the file.
struct NamedMesh : ComponentMesh {
  /// Lists of names, the most specific first: of a material, of groups or of a mesh, of an object or a
  /// node. A list may be empty.
  std::vector<std::vector<std::string>> names;
  std::vector<std::uint32_t> names_of;  ///< index of the list of names, by triangle
};

/// Reads a mesh file in metres, z up. The extension identifies OBJ, PLY (ASCII, binary), STL (ASCII,
/// binary) and OFF. These formats do not state units and axes; the defaults are metres and z up. The first
/// bytes identify COLLADA, glTF, 3DS and FBX, which Assimp reads. They are rejected if neither the file nor
/// the scene states the up axis and the unit. The unit of COLLADA is 1 m by default, with a warning.
///
/// Every face becomes part of the scene, manifold or not. Polygons are divided into triangles. A warning
/// counts faces with fewer than three corners. Points without a face are removed. Throws InputError with
/// the file and, for text, line and column. Errors are an empty or truncated file, no facets, coordinates
/// that are not finite, indices out of range, and self-intersecting polygons.
///
/// OpenMesh's readers, and Assimp for the other formats, are not suitable (tests with OpenMesh 9.0 and
/// Assimp 5.2). They convert coordinates to float (7246504.12 m becomes 7246504 m). OpenMesh drops a vertex
/// that is not a number, which shifts all later indices. It accepts truncated files and returns faces with
/// uninitialised indices. Its half-edge structure would also reject faces at complex vertices and edges.
NamedMesh read_mesh_file(const std::filesystem::path& file, const MeshAxes& axes = {});

/// Returns how many of the facets [first, last) OpenMesh's half-edge structure rejects, in order of their
/// ids. These are facets at complex vertices or edges, and facets with a repeated vertex. The count is for
/// the report only; all facets stay in the scene.
std::size_t facets_outside_halfedge(const FacetMesh& mesh, FacetId first, FacetId last);

}  // namespace tubefoot
