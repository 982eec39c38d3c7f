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

/// `count` slivers, 4 to 8 m long and 2 to 6 cm wide at one end, that lie across one another in all
/// directions about 10 m ahead, from 9 to 11 m away at either end: they pass through each other.
FacetMesh benchmark_interlaced_strips(int count);

/// The middle 2 m x 2 m of the weave, as one tube.
TubeSet interlaced_strips_tube();

}  // namespace tubefoot
