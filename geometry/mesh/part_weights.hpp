// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tubefoot {

/// Facets and edges can be cut in half this often.
constexpr int deepest_refinement = 22;

/// Weights of corners are integers: parts of this. A part of a part still has exact ones.
inline constexpr std::int64_t whole_weight = std::int64_t{1} << (2 * deepest_refinement);

/// Where the corners of a part of a facet lie on it: weights of its second and third corner.
using PartWeights = std::array<std::array<std::int64_t, 2>, 3>;

inline constexpr PartWeights all_of_it{{{0, 0}, {whole_weight, 0}, {0, whole_weight}}};

/// Of a part of a part, both of at most deepest_refinement halvings: where it lies on the whole.
/// Law D5 (parts of parts): a point of a part of a part lies on the whole where it lies on the part.
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
