// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "geometry/footprints/footprint.hpp"
#include "geometry/tubes/tube.hpp"
#include "geometry/visibility/visibility.hpp"

namespace tubefoot {

/// Appends the visible polygons of tube `tube` as footprints with coordinates in metres (grid unit `unit_m`).
/// The planes are set; measure() (measure.hpp) has not been called. Coordinates are the exact ones, rounded
/// once. The unobstructed region follows if `seen` has it. With `corner_names` the names of the corners
/// follow too.
void append_footprints(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t tube,
                       const TubeVisibility& seen, double unit_m, FootprintSet& set,
                       bool corner_names = false);

/// Moves a name to rays that begin at `first_ray`. All ids of rays grow by the same number, so the order of
/// the points of a plane does not change.
inline CornerName moved(CornerName name, std::uint32_t first_ray) {
  for (PointId* id : {&name.point, &name.p.a, &name.p.b, &name.q.a, &name.q.b})
    if (*id != no_point && (*id & ray_bit)) *id += first_ray;
  return name;
}

/// Concatenates all sets in their order.
FootprintSet joined(std::span<const FootprintSet> sets);

}  // namespace tubefoot
