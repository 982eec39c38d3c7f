// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tubefoot {

/// Maximum number of times that facets and edges can be halved.
constexpr int deepest_refinement = 22;

/// Weights of corners are integers, in parts of this number. The weights of a part of a part are still exact.
inline constexpr std::int64_t whole_weight = std::int64_t{1} << (2 * deepest_refinement);

/// Positions of the corners of a part on its facet, as weights of the facet's second and third corner.
using PartWeights = std::array<std::array<std::int64_t, 2>, 3>;

inline constexpr PartWeights all_of_it{{{0, 0}, {whole_weight, 0}, {0, whole_weight}}};

/// Returns the position of a part of a part on the whole facet. Both parts result from at most
/// deepest_refinement halvings.
///
/// Law D5 (parts of parts): the position on the whole is that of the corresponding point of the part.
inline PartWeights part_of_part(const PartWeights& part, const PartWeights& of_it) {
  PartWeights on_whole = part;
  constexpr int half = deepest_refinement;
  for (std::size_t corner = 0; corner < 3; ++corner)
    for (std::size_t k = 0; k < 2; ++k)
      on_whole[corner][k] = part[0][k] + (of_it[corner][0] >> half) * ((part[1][k] - part[0][k]) >> half) +
                            (of_it[corner][1] >> half) * ((part[2][k] - part[0][k]) >> half);
  return on_whole;
}

}  // namespace tubefoot
