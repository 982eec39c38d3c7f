// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// Tubes cut lengthwise into adjacent parts of equal angle.
struct CutTubes {
  TubeSet set;
  std::vector<std::uint32_t> whole;   ///< original tube of each part
  std::vector<std::uint32_t> column;  ///< column of each part; each column belongs to one beam
};

/// Cuts each beam, a single tube or a grid of tubes, into `columns` columns along its longer side. The
/// parts of a tube cover the tube except for the rounding of rays. Throws std::invalid_argument if the
/// number of tubes across a beam does not divide the number of columns.
CutTubes cut_into_columns(const TubeSet& set, std::span<const std::uint32_t> beam_of_tube,
                          std::size_t columns);

}  // namespace tubefoot
