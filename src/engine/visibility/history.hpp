// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/visibility/ray_hits.hpp"
#include "geometry/footprints/footprint.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// Footprints and hits of one transmission from one apex: the input of every sensor. A history describes
/// facets, tubes and geometry, but no sound and no sensor. A path is apex -> facet -> apex, so a footprint
/// (or a hit) is a path.
struct History {
  TubeSet tubes;
  double grid_unit_m = 1;   ///< metres per grid unit of `tubes`
  FootprintSet footprints;  ///< written by the tube engine
  RayHits hits;             ///< written by the ray engine
};

}  // namespace tubefoot
