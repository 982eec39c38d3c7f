// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/search/scene_tree.hpp"

namespace tubefoot {

/// Returns whether no facet lies between two points, exactly. A facet hides the points if the line from one
/// to the other meets it or its border before the line ends. Two kinds of facets are ignored: facets whose
/// plane contains `from`, and facets met in the first `open_part` (0 to 1) of the line. The latter comparison
/// is made in double.
///
/// Law I3 (line of sight): the result is that of rational arithmetic.
bool in_view(const FacetMesh& mesh, const SceneTree& tree, GridPoint from, GridPoint to,
             double open_part = 0);

}  // namespace tubefoot
