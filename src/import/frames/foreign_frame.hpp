// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of other engines as their files contain them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace tubefoot {

/// One picture of another engine as in its file, before any assumption.
struct ForeignFrame {
  std::size_t rows = 0, columns = 0;
  std::vector<double> values;       ///< row by row, as stored
  bool eight_bits = false;          ///< values were integers from 0 to 255
  std::vector<double> range_m;      ///< ranges of the rows or columns if the file has them, else empty
  std::vector<double> azimuth_rad;  ///< azimuths of the beams if the file has them, else empty
  std::optional<double> time_s;
};
/// All frames of a file, with remarks from reading it.
struct ForeignData {
  std::vector<ForeignFrame> frames;
  std::vector<std::string> noticed;
};

}  // namespace tubefoot
