// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "scene/description/scene_description.hpp"
#include "scene/meshes/mesh_file.hpp"
#include "scene/scene.hpp"

namespace tubefoot {

/// Gives each facet of an object's mesh file the material that the object's table has for the first of its
/// names that is in the table, else the object's own. Returns what the facets go by, in the order of the
/// file. Throws InputError at an entry whose name no facet has.
std::vector<NamedFacets> apply_mesh_materials(NamedMesh& mesh, const ObjectDescription& object,
                                              const std::vector<MaterialDescription>& materials);

}  // namespace tubefoot
