// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot {

constexpr int terrain_grid_exponent = 20;

/// The benchmark terrain: 20 m x 20 m, 2 n^2 facets, smooth relief of about half a metre plus white roughness
/// of one fifth of the cell, seen from 3 m above and 2 m before one edge. Seeded: the same on every machine.
/// The apex is the origin. `hidden_behind` adds that many sheets of the same size below the first, of which
/// nothing is seen.
FacetMesh benchmark_terrain(int n, int hidden_behind = 0);

/// The sector of the benchmark: 29 x 24 degrees, tilted 14 degrees down, in `columns` tubes.
TubeSet benchmark_sector(int columns);

}  // namespace tubefoot
