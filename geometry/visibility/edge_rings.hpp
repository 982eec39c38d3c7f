// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/visibility/gnomonic_frame.hpp"

namespace tubefoot {

/// Finds the facets of a list that share an edge. Half-edge 3 f + k is edge k of facet f, from corner k of
/// its cone to the next. The half-edges of one edge form a ring. The object reuses its table from list to
/// list.
class EdgeRings {
 public:
  void build(const std::vector<RangedFacet>& facets);

  /// Returns the next half-edge on the same edge, or the half-edge itself if no other facet has the edge.
  std::uint32_t next(std::uint32_t half_edge) const { return next_[half_edge]; }

 private:
  struct Slot {
    VertexId a, b;
    std::uint32_t half_edge;
  };
  std::vector<std::uint32_t> next_;
  std::vector<Slot> table_;
};

}  // namespace tubefoot
