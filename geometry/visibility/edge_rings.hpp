// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/visibility/gnomonic_frame.hpp"
#include "geometry/visibility/layer_grid.hpp"

namespace tubefoot {

/// Finds the facets of a list that share an edge. Half-edge 3 f + k is edge k of facet f, from corner k of
/// its cone to the next. The half-edges of one edge form a ring. The object reuses its table from list to
/// list.
class EdgeRings {
 public:
  void build(const std::vector<RangedFacet>& facets);

  /// Computes the neighbours of the facets `chosen` of the list, in the order of `chosen`. A facet is crowded
  /// if at least `crowd` other facets share one of its edges. Two facets are neighbours if they alone have an
  /// edge and lie on opposite sides of its plane through the apex. All corners turn the same way, so this is
  /// the case if they pass through the edge in opposite directions.
  void find_neighbours(const std::vector<RangedFacet>& facets, const std::vector<std::uint32_t>& chosen,
                       std::uint32_t crowd, std::vector<Neighbours>& neighbours,
                       std::vector<std::uint8_t>& crowded);

  /// Returns the next half-edge on the same edge, or the half-edge itself if no other facet has the edge.
  std::uint32_t next(std::uint32_t half_edge) const { return next_[half_edge]; }

 private:
  struct Slot {
    VertexId a, b;
    std::uint32_t half_edge;
  };
  std::vector<std::uint32_t> next_;
  std::vector<Slot> table_;
  std::vector<std::uint32_t> place_;  ///< per facet of the list: its place in `chosen`
};

}  // namespace tubefoot
