// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>

#include "geometry/mesh/part_weights.hpp"
#include "geometry/tubes/mirror.hpp"

namespace tubefoot {

/// Returns the weights of a part that in_front_of() cut, relative to the whole facet of which the cut facet
/// is a part. The rounding does not depend on the order of the corners, so points on an edge of the whole
/// stay on it.
inline PartWeights weights_of(const std::array<PartCorner, 3>& corners, const PartWeights& of_whole) {
  PartWeights weights;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < 2; ++k) {
      const std::int64_t from = of_whole[corners[c].from][k], to = of_whole[corners[c].to][k];
      weights[c][k] = from + static_cast<std::int64_t>(
                                 std::llround(corners[c].part * static_cast<long double>(to - from)));
    }
  return weights;
}

/// The same as part_of_part() for parts with any weights. Rounded.
inline PartWeights rounded_part_of_part(const PartWeights& part, const PartWeights& of_it) {
  PartWeights on_whole = part;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < 2; ++k)
      on_whole[c][k] =
          part[0][k] +
          static_cast<std::int64_t>(std::llround(
              (static_cast<long double>(of_it[c][0]) * static_cast<long double>(part[1][k] - part[0][k]) +
               static_cast<long double>(of_it[c][1]) * static_cast<long double>(part[2][k] - part[0][k])) /
              static_cast<long double>(whole_weight)));
  return on_whole;
}

}  // namespace tubefoot
