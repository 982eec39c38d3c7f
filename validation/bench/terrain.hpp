// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/mesh/facet_mesh.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot {

constexpr int terrain_grid_exponent = 20;

/// Returns the benchmark terrain: 20 m x 20 m with 2 n^2 facets. It has smooth relief of about half a metre
/// and white roughness of one fifth of the cell. The apex is the origin, 3 m above the terrain and 2 m in
/// front of one edge. The seed is fixed, so that the terrain is the same on every machine. `hidden_behind`
/// adds that many sheets of the same size below the first, which are never visible.
FacetMesh benchmark_terrain(int n, int hidden_behind = 0);

/// Returns the sector of the benchmark: 29 x 24 degrees, tilted 14 degrees down, in `columns` tubes.
TubeSet benchmark_sector(int columns);

/// Returns `count` slivers, 4 to 8 m long and 2 to 6 cm wide at one end. They lie across each other in all
/// directions about 10 m ahead. Their ends are 9 to 11 m away, so that they pass through each other.
FacetMesh benchmark_interlaced_strips(int count);

/// Returns the central 2 m x 2 m of the interlaced strips, as one tube.
TubeSet interlaced_strips_tube();

}  // namespace tubefoot
