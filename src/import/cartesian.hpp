// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "import/arrangement.hpp"
#include "import/bin_axes.hpp"

namespace tubefoot {

/// Where a fan lies in a picture of even pixels: ahead is up.
struct FanPlace {
  double apex_column = 0, apex_row = 0;  ///< in pixels from the picture's upper left corner
  double metres_a_pixel = 0;
};

/// "COLUMN:ROW:METRES", or "fan": the fan of these axes fills a picture of so many rows and columns. Throws
/// UsageError, also for a picture whose sides are not the fan's.
FanPlace fan_place(const std::string& words, std::size_t rows, std::size_t columns, const BinAxes& axes);

/// A frame turned so that ahead is up; `forward`: up, down, left or right, where it is.
ForeignFrame turned_up(const ForeignFrame& frame, const std::string& forward);

/// Means of the picture's energies over each beam and sample: of points so close that every pixel which a bin
/// meets counts by its part of it. `outside`, if given, counts bins that the picture does not have.
PolarPicture resampled_fan(const std::vector<double>& energies, std::size_t rows, std::size_t columns,
                           const FanPlace& place, const BinAxes& axes, std::size_t* outside = nullptr);

}  // namespace tubefoot
