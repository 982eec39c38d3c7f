// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "engine/relief/spline_surface.hpp"

namespace tubefoot {

/// Heights at the nodes of a lattice.
struct HeightMap {
  std::size_t columns = 0, rows = 0;
  double west_m = 0, south_m = 0;  ///< of the first node
  double spacing_x_m = 1, spacing_y_m = 1;
  bool periodic = true;          ///< repeated after columns and rows; otherwise the height is 0 outside
  std::vector<double> height_m;  ///< row by row from the south-west
};

/// Returns the bicubic B-spline through the nodes. If the map is not periodic, the spline decreases to 0
/// beyond the outermost nodes, within kMapBorder node distances.
std::shared_ptr<const SplineSurface> make_surface(HeightMap map);
inline constexpr std::size_t kMapBorder = 16;

}  // namespace tubefoot
