// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot {

/// Removes invalid corners that plain double arithmetic may produce: corners of two coincident planes, and
/// corners behind the apex. They are removed from pieces and from the unobstructed region. Pieces with fewer
/// than three remaining corners are removed too. All remaining names are then directions, as with any other
/// arithmetic. Results of an exact arithmetic are not changed.
void leave_out_contradictions(const FacetMesh& mesh, GridPoint apex, TubeVisibility& seen);

}  // namespace tubefoot
