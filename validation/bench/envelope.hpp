// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// Compares the time of the lower envelope of triangles of CGAL (Envelope_3, rational kernel) with that of
/// `fixed`. Both compute the visible parts in a tube. Returns the ratio of the times.
///
/// Both receive the facets that no wall of the tube separates from it. The map (x, y, z) -> (z/y, x/y, -1/y)
/// makes the rays of the apex vertical for the envelope. All vertices must have a larger y than the apex.
/// `fixed` uses a tree that is built before. The result is the median of interleaved repetitions.
double envelope_over_fixed(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t tube);

}  // namespace tubefoot
