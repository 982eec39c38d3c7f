// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/visibility/ray_hits.hpp"
#include "geometry/footprints/footprint.hpp"
#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// What one transmission met, seen from one apex: the value that every sensor reads. It knows facets, tubes
/// and geometry, no sound and no sensor. A path is apex -> facet -> apex, so a footprint (or a hit) is a
/// path.
struct History {
  TubeSet tubes;
  double grid_unit_m = 1;   ///< metres per grid unit of `tubes`
  FootprintSet footprints;  ///< filled by the tube engine
  RayHits hits;             ///< filled by the ray engine
};

}  // namespace tubefoot
