// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "geometry/layer_grid.hpp"

namespace tubefoot {

/// Pairs up the facets of a tube across their edges. Keeps its table from tube to tube.
class NeighbourFinder {
 public:
  /// `unfolded(f, edge, g)` must be true only if facets f and g, which share that edge of f, lie on opposite
  /// sides of its plane; `edge_outside(f, edge)` only if the edge does not enter the tube. Both must be
  /// exact.
  template <class Unfolded, class EdgeOutside>
  void find(const std::vector<SeenFacet>& facets, std::vector<Neighbours>& neighbours,
            const Unfolded& unfolded, const EdgeOutside& edge_outside) {
    neighbours.assign(facets.size(), Neighbours{silhouette, silhouette, silhouette});
    const std::size_t size = std::bit_ceil(facets.size() * 4 + 1);
    table_.assign(size, Slot{});
    for (std::uint32_t f = 0; f < facets.size(); ++f)
      for (std::uint32_t k = 0; k < 3; ++k) {
        Slot& slot = slot_of(facets[f].cone.vertex[k], facets[f].cone.vertex[(k + 1) % 3]);
        if (slot.count < 2) slot.side[slot.count] = f * 4 + k;
        if (slot.count < 3) ++slot.count;
      }
    for (const Slot& slot : table_) {
      if (slot.count == 0 || slot.count > 2) continue;  // three facets on an edge: a silhouette of each
      const std::uint32_t f = slot.side[0] / 4, k = slot.side[0] % 4;
      if (slot.count == 1) {
        if (edge_outside(f, k)) neighbours[f][k] = outside_tube;
        continue;
      }
      const std::uint32_t g = slot.side[1] / 4, j = slot.side[1] % 4;
      if (!unfolded(f, k, g)) continue;
      neighbours[f][k] = static_cast<std::int32_t>(g);
      neighbours[g][j] = static_cast<std::int32_t>(f);
    }
  }

 private:
  struct Slot {
    VertexId a = 0, b = 0;
    std::uint32_t count = 0;
    std::uint32_t side[2] = {0, 0};  ///< facet * 4 + edge
  };

  Slot& slot_of(VertexId a, VertexId b) {
    if (a > b) std::swap(a, b);
    std::uint64_t h = (std::uint64_t(a) << 32 | b) * 0x9e3779b97f4a7c15u;
    h ^= h >> 29;
    for (std::size_t k = h & (table_.size() - 1);; k = (k + 1) & (table_.size() - 1)) {
      Slot& slot = table_[k];
      if (slot.count == 0) {
        slot.a = a;
        slot.b = b;
        return slot;
      }
      if (slot.a == a && slot.b == b) return slot;
    }
  }

  std::vector<Slot> table_;
};

}  // namespace tubefoot
