// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// How many times longer CGAL's lower envelope of triangles (Envelope_3, rational kernel) takes than `fixed`
/// for what is seen through a tube; both get the facets that no wall of the tube sets apart from it, and no
/// others. The envelope sees them through the map (x, y, z) -> (z/y, x/y, -1/y), which makes the apex's rays
/// vertical; all vertices must lie ahead of the apex, in y. `fixed` gets a tree built beforehand. Median of
/// interleaved repeats.
double envelope_over_fixed(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t tube);

}  // namespace tubefoot
