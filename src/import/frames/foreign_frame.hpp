// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of other engines as their files hold them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace tubefoot {

/// One picture of another engine as its file holds it, before anything is assumed of it.
struct ForeignFrame {
  std::size_t rows = 0, columns = 0;
  std::vector<double> values;       ///< row by row, as stored
  bool eight_bits = false;          ///< were whole numbers 0 to 255
  std::vector<double> range_m;      ///< of the rows or columns, where the file says it; else empty
  std::vector<double> azimuth_rad;  ///< of the beams, where the file says it; else empty
  std::optional<double> time_s;
};
/// All frames of a file, with what was noticed while reading.
struct ForeignData {
  std::vector<ForeignFrame> frames;
  std::vector<std::string> noticed;
};

}  // namespace tubefoot
