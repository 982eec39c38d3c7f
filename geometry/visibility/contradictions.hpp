// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot {

/// Plain double arithmetic may name corners that are none: of two planes that coincide, or behind the apex.
/// Leaves these out, of pieces and of open water, and pieces of which less than three corners are left: all
/// that are named then are directions, as any other arithmetic's. Of an exact arithmetic nothing is left out.
void leave_out_contradictions(const FacetMesh& mesh, GridPoint apex, TubeVisibility& seen);

}  // namespace tubefoot
