// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/tubes/tube.hpp"

namespace tubefoot {

/// Tubes cut lengthwise into parts of equal angle, side by side.
struct CutTubes {
  TubeSet set;
  std::vector<std::uint32_t> whole;   ///< by part: the tube that it is of
  std::vector<std::uint32_t> column;  ///< by part: which column of which beam it belongs to
};

/// Cuts each beam, one tube or a grid of tubes, into as many columns along its longer side. The parts of a
/// tube are what it was, but for the rounding of rays. Throws std::invalid_argument where a beam is several
/// tubes wide, which the columns are no multiple of.
CutTubes cut_into_columns(const TubeSet& set, std::span<const std::uint32_t> beam_of_tube,
                          std::size_t columns);

}  // namespace tubefoot
