// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace tubefoot {

/// A plane that a robust fit determines: z = height_m + slope_east (x - centre.x) + slope_north (y -
/// centre.y).
struct FittedPlane {
  glm::dvec3 centre_m{0};  ///< centre of the used points, on the plane
  double slope_east = 0, slope_north = 0;
  glm::dvec2 lo_m{0}, hi_m{0};  ///< extent of the used points
  double rms_m = 0;             ///< of the used points
  std::size_t used = 0, removed = 0;
  bool is_narrow = false;  ///< the slope in the direction of the shorter extent is 0 (fitted_plane())

  double height_m(glm::dvec2 at_m) const {
    return centre_m.z + slope_east * (at_m.x - centre_m.x) + slope_north * (at_m.y - centre_m.y);
  }
};

/// Fits a plane by least squares. Points further from the plane than `most_deviations` times the
/// normal-consistent median absolute deviation are removed, until no further point is removed. A narrow strip
/// of points does not determine the slope in the direction of its width. If the standard deviation of the
/// positions in this direction is below a tenth of that along the strip, this slope is 0. Throws
/// std::invalid_argument for fewer than 3 points, and for points on a line.
FittedPlane fitted_plane(const std::vector<glm::dvec3>& points_m, double most_deviations);

/// A surface of a regular grid of square cells, as triangles.
struct SeabedGrid {
  std::vector<glm::dvec3> points_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::size_t filled = 0;   ///< nodes without soundings
  std::size_t removed = 0;  ///< outliers
  double rms_m = 0;         ///< of the soundings about the medians of their cells
};

/// Each node has the median height of the soundings of its cell. Soundings further than `outlier_m` from the
/// median of their block of 4 x 4 cells are outliers, which are removed. Nodes without soundings have the
/// mean residual of their neighbours from the plane, ring by ring, and far from soundings the height of the
/// plane. The grid extends by `margin_m` beyond the soundings. Throws std::invalid_argument for more than
/// 10^6 nodes.
SeabedGrid seabed_grid(const std::vector<glm::dvec3>& points_m, const FittedPlane& plane, double cell_m,
                       double margin_m, double outlier_m);

}  // namespace tubefoot
