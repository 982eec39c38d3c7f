// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/search/scene_tree.hpp"

namespace tubefoot {

/// Whether no facet comes between two points, exactly: a facet hides if the straight line from one to the
/// other meets it, or its border, before it ends. Facets whose plane holds `from` hide nothing, nor do those
/// met in the first `open_part` (0 to 1) of the line, which is compared in double.
/// Law I3 (line of sight): the answer is that of rational arithmetic.
bool in_view(const FacetMesh& mesh, const SceneTree& tree, GridPoint from, GridPoint to,
             double open_part = 0);

}  // namespace tubefoot
