// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "files/input_error.hpp"
#include "import/frames/foreign_frame.hpp"

namespace tubefoot {

/// Numbers along axes, with the name that a file has them under.
struct NumberArray {
  std::string name;
  std::vector<std::size_t> shape;
  std::vector<double> values;  ///< the last axis runs fastest
  bool eight_bits = false;     ///< were unsigned bytes
};

/// Which of a file's arrays is the picture, and which are its axes, where a file has several.
struct WantedArrays {
  std::string variable, range_variable, azimuth_variable;  ///< empty: the only one there is, or none
  bool points = false;  ///< a last axis of three has x, y and the value of each bin (OceanSim)
};

/// The product of some lengths; throws InputError at `place` where it is more than a machine can count.
std::size_t counted(const std::vector<std::size_t>& shape, const SourcePlace& place);

/// Pictures of an array of two axes, or of three: several pictures one after the other. The last of three may
/// have the three or four colours of bytes, all alike. `ranges` and `azimuths` may be null. Throws
/// InputError.
ForeignData frames_of(const NumberArray& picture, const NumberArray* ranges_m,
                      const NumberArray* azimuths_rad, bool points, const SourcePlace& place);

/// Picks them of all a file has. Throws InputError, which names those that there are.
ForeignData frames_of(const std::vector<NumberArray>& arrays, const WantedArrays& wanted,
                      const SourcePlace& place);

}  // namespace tubefoot
