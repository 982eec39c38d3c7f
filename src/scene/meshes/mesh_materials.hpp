// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scene/description/material_description.hpp"
#include "scene/description/object_description.hpp"
#include "scene/meshes/mesh_file.hpp"

namespace tubefoot {

/// Facets of a mesh file with the same name in the file.
struct NamedFacets {
  std::string name, material;  ///< name in the file, material in the scene
  std::size_t facets = 0;
};

/// Assigns materials to the facets of an object's mesh file. A facet gets the material of the first of its
/// names that the object's table contains, otherwise the object's own material. Returns the names of the
/// facets, in the order of the file. Throws InputError at an entry whose name no facet has.
std::vector<NamedFacets> apply_mesh_materials(NamedMesh& mesh, const ObjectDescription& object,
                                              const std::vector<MaterialDescription>& materials);

}  // namespace tubefoot
