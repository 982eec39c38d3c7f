// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

/// Hash table of grid points with open addressing. It takes 8 bytes per vertex, where std::unordered_map
/// takes more than 40. New points are appended to `vertices`.
class WeldTable {
 public:
  explicit WeldTable(std::vector<GridPoint>& vertices) : vertices_(vertices) {}

  void reserve(std::size_t vertices) {
    const std::size_t wanted = std::bit_ceil(2 * vertices + 16);
    if (wanted <= slots_.size()) return;
    slots_.assign(wanted, none);
    for (VertexId id = 0; id < vertices_.size(); ++id) slots_[slot_of(vertices_[id])] = id;
  }

  /// Requires a preceding reserve() for the point. Throws std::length_error.
  VertexId id_of(GridPoint p) {
    VertexId& slot = slots_[slot_of(p)];
    if (slot == none) {
      // Names of points (names.hpp) use the top bit.
      if (vertices_.size() >= 0x80000000u) throw std::length_error("a mesh holds at most 2^31 vertices");
      slot = static_cast<VertexId>(vertices_.size());
      vertices_.push_back(p);
    }
    return slot;
  }

 private:
  static constexpr VertexId none = std::numeric_limits<VertexId>::max();

  // Returns the slot that contains p, or the free slot for p.
  std::size_t slot_of(GridPoint p) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = GridPointHash{}(p)&mask;
    while (slots_[slot] != none && vertices_[slots_[slot]] != p) slot = (slot + 1) & mask;
    return slot;
  }

  std::vector<GridPoint>& vertices_;
  std::vector<VertexId> slots_;
};

}  // namespace tubefoot
