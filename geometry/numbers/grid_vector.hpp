// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>

#include "geometry/numbers/world_grid.hpp"

namespace tubefoot {

/// Returns the vector from one grid point to another, in grid units. Exact: differences of coordinates have
/// at most 33 bits.
inline glm::dvec3 displacement(GridPoint from, GridPoint to) {
  return {double(to.x) - from.x, double(to.y) - from.y, double(to.z) - from.z};
}
/// The same in metres. Exact, because units are powers of two.
inline glm::dvec3 displacement_m(GridPoint from, GridPoint to, double grid_unit_m) {
  return displacement(from, to) * grid_unit_m;
}

}  // namespace tubefoot
