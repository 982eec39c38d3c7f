// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "files/input_error.hpp"
#include "import/frames/foreign_frame.hpp"

namespace tubefoot {

/// A named array of numbers from a file.
struct NumberArray {
  std::string name;
  std::vector<std::size_t> shape;
  std::vector<double> values;  ///< the last axis varies fastest
  bool eight_bits = false;     ///< values were unsigned bytes
};

/// Names of the arrays of the picture and of its axes, for files with several arrays.
struct WantedArrays {
  std::string variable, range_variable, azimuth_variable;  ///< empty: the only array, or none
  bool points = false;  ///< a last axis of length three contains x, y and the value of each bin (OceanSim)
};

/// Returns the product of the lengths. Throws InputError at `place` on overflow.
std::size_t counted(const std::vector<std::size_t>& shape, const SourcePlace& place);

/// Returns the pictures of an array of two axes, or of three axes for a sequence of pictures. The last of
/// three axes may contain three or four equal colour channels of bytes. `ranges` and `azimuths` may be
/// null. Throws InputError.
ForeignData frames_of(const NumberArray& picture, const NumberArray* ranges_m,
                      const NumberArray* azimuths_rad, bool points, const SourcePlace& place);

/// Selects the arrays among those of a file. Throws InputError, which names the available arrays.
ForeignData frames_of(const std::vector<NumberArray>& arrays, const WantedArrays& wanted,
                      const SourcePlace& place);

}  // namespace tubefoot
