// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "import/arrangement.hpp"
#include "import/bin_axes.hpp"

namespace tubefoot {

/// Position of a fan in a picture with square pixels, in which ahead is up.
struct FanPlace {
  double apex_column = 0, apex_row = 0;  ///< in pixels from the upper left corner of the picture
  double metres_a_pixel = 0;
};

/// Parses "COLUMN:ROW:METRES", or "fan": the fan of these axes fills a picture of these rows and columns.
/// Throws UsageError, also if the aspect ratio of the picture does not match the fan.
FanPlace fan_place(const std::string& words, std::size_t rows, std::size_t columns, const BinAxes& axes);

/// Rotates a frame so that ahead is up. `forward` is the present direction of ahead: up, down, left or
/// right.
ForeignFrame turned_up(const ForeignFrame& frame, const std::string& forward);

/// Returns the means of the energies of the picture over each beam and sample. The sampling points are so
/// dense that each pixel counts in proportion to its overlap with the bin. `outside`, if not null, counts
/// the bins outside of the picture.
PolarPicture resampled_fan(const std::vector<double>& energies, std::size_t rows, std::size_t columns,
                           const FanPlace& place, const BinAxes& axes, std::size_t* outside = nullptr);

}  // namespace tubefoot
