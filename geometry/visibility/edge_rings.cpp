// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/visibility/edge_rings.hpp"

#include <bit>
#include <utility>

namespace tubefoot {

void EdgeRings::build(const std::vector<RangedFacet>& facets) {
  constexpr std::uint32_t none = 0xffffffffu;
  const std::size_t size = std::bit_ceil(facets.size() * 4 + 1);
  table_.assign(size, Slot{0, 0, none});
  next_.resize(3 * facets.size());
  for (std::uint32_t f = 0; f < facets.size(); ++f)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto& vertex = facets[f].cone.vertex;
      VertexId a = vertex[k], b = vertex[(k + 1) % 3];
      if (a > b) std::swap(a, b);
      const std::uint32_t half_edge = 3 * f + k;
      std::uint64_t h = (std::uint64_t(a) << 32 | b) * 0x9e3779b97f4a7c15u;
      h ^= h >> 29;
      std::size_t at = h & (size - 1);
      while (table_[at].half_edge != none && !(table_[at].a == a && table_[at].b == b))
        at = (at + 1) & (size - 1);
      Slot& slot = table_[at];
      if (slot.half_edge == none) {
        slot = {a, b, half_edge};
        next_[half_edge] = half_edge;
      } else {
        next_[half_edge] = next_[slot.half_edge];
        next_[slot.half_edge] = half_edge;
      }
    }
}

void EdgeRings::find_neighbours(const std::vector<RangedFacet>& facets,
                                const std::vector<std::uint32_t>& chosen, std::uint32_t crowd,
                                std::vector<Neighbours>& neighbours, std::vector<std::uint8_t>& crowded) {
  constexpr std::uint32_t absent = 0xffffffffu;
  const auto count = static_cast<std::uint32_t>(chosen.size());
  neighbours.assign(count, Neighbours{silhouette, silhouette, silhouette});
  crowded.assign(count, 0);
  place_.assign(facets.size(), absent);
  for (std::uint32_t f = 0; f < count; ++f) place_[chosen[f]] = f;
  for (std::uint32_t f = 0; f < count; ++f)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t half_edge = 3 * chosen[f] + k;
      std::uint32_t others = 0, mate = half_edge;
      for (std::uint32_t h = next(half_edge); h != half_edge && others < crowd; h = next(h))
        if (place_[h / 3] != absent) {
          ++others;
          mate = h;
        }
      if (others == crowd) crowded[f] = 1;
      if (others == 1 &&
          facets[mate / 3].cone.vertex[mate % 3] != facets[half_edge / 3].cone.vertex[half_edge % 3])
        neighbours[f][k] = static_cast<std::int32_t>(place_[mate / 3]);
    }
}

}  // namespace tubefoot
