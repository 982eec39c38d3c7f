// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/numbers/lane_bits.hpp"
#include "geometry/visibility/gnomonic_frame.hpp"

// Finds hidden facets and pairs of facets that need an exact test, with a grid of cells in the gnomonic plane
// of a tube. All decisions are made in double with margins (docs/notes/visibility.md, 'Layers').

namespace tubefoot {

/// Special values for the neighbour across an edge of a facet, as seen from the apex.
constexpr std::int32_t silhouette = -1;    ///< no facet, a fold, or more than one facet
constexpr std::int32_t outside_tube = -2;  ///< any neighbour; the edge does not enter the tube

/// Neighbours across the three edges: a facet's index, silhouette or outside_tube. Edge k runs from vertex k
/// to k + 1.
using Neighbours = std::array<std::int32_t, 3>;

/// Finds the facets of a tube that are certainly hidden, and the pairs that need an exact test, without exact
/// predicates.
///
/// The argument is this (docs/notes/visibility.md, 'Layers'). The gnomonic plane is divided into cells. In
/// each cell, the facets that are connected by shared edges form layers. Consider a layer none of whose
/// silhouette edges enters the cell. It covers every point of the cell within the tube equally often, because
/// a step across a shared edge leaves one facet and enters one. So one point decides. A layer that covers it
/// hides everything that lies wholly beyond the layer's farthest facet. A layer that covers it once does not
/// overlap itself anywhere in the cell.
class LayerGrid {
 public:
  /// Builds the grid. Facets and neighbours have the same indices and must outlive the grid's use.
  void build(const GnomonicFrame& frame, const std::vector<FramedFacet>& facets,
             const std::vector<Neighbours>& neighbours);

  /// Law L1 (hidden): returns true only if no part of the facet is visible. The facet then hides nothing that
  /// others do not hide.
  bool is_hidden(std::uint32_t facet) const { return hidden_[facet] != 0; }

  /// Law L4 (front): returns true only if no part of anything within the bounds and beyond the distance is
  /// visible in the tube.
  bool hides(const Bounds& bounds, double nearest) const;

  /// Law L2 (occluders): writes every facet to `out` that may hide part of `facet`, nearest first. Facets
  /// that are certainly disjoint from it, and facets that are hidden themselves, are omitted.
  void occluder_candidates(std::uint32_t facet, std::vector<std::uint32_t>& out);

 private:
  struct Cells {
    int x0, x1, y0, y1;
  };
  /// Bounds in single precision, rounded outwards.
  struct RoundedBounds {
    FourFloats ends;  ///< x0, y0, -x1, -y1
    explicit RoundedBounds(const Bounds& b);
    /// Returns the largest ends of bounds that meet these bounds.
    FourFloats reach() const { return -__builtin_shufflevector(ends, ends, 2, 3, 0, 1); }
    bool within(const FourFloats& reach) const { return bits_of(FourLanes(ends <= reach)) == 0b1111; }
  };
  struct Cell {
    std::uint32_t begin = 0, end = 0;  ///< range in entries_
    bool has_simple_layer = false;
    bool is_simple_layer = false;  ///< all remaining entries belong to one simple layer
    /// Every facet wholly beyond this distance is hidden in this cell.
    double closed_beyond = std::numeric_limits<double>::infinity();
  };
  struct Entry {
    double nearest;  ///< of the facet; a cell's entries are sorted by it
    std::uint32_t facet;
    std::int32_t simple_layer;  ///< layer that covers this cell exactly once, by its root; or no_layer
    RoundedBounds bounds;       ///< of the facet; stored here because every pair of a cell needs them
  };
  static constexpr std::int32_t no_layer = -1, own_layer_is_none = -2;
  struct Found {
    double nearest;
    std::uint32_t facet;
    bool overlaps;  ///< known not to be disjoint
  };
  /// The result of an earlier comparison with `facet`.
  struct Judgement {
    std::uint32_t facet, next;
    bool apart;
  };
  static constexpr std::uint32_t no_more = 0xffffffffu;
  using Directions = std::array<glm::dvec3, 4>;  ///< of a cell's corners, unit vectors

  void choose_size();
  Cells cells_of(const Bounds& bounds) const;
  Bounds bounds_of(int x, int y) const;
  void fill();
  bool has_silhouette_in(std::uint32_t facet, const Bounds& cell, const Directions& corners) const;
  /// As where(), also for facets without a position in the plane.
  int place_of(const FramedFacet& facet, glm::dvec2 p) const;
  /// Returns a bound on the distance of the facet's part in a cell.
  double farthest_in(std::uint32_t facet, const Directions& corners) const;
  void find_layers(int x, int y);
  bool find_layers(Cell& cell, const Bounds& box, const Directions& corners, std::uint32_t begin,
                   std::uint32_t end);
  bool are_closed(const Cells& cells, double nearest) const;
  void find_hidden();
  void drop_hidden();

  const GnomonicFrame* frame_ = nullptr;
  const std::vector<FramedFacet>* facets_ = nullptr;
  const std::vector<Neighbours>* neighbours_ = nullptr;
  int columns_ = 1, rows_ = 1;
  double cell_width_ = 1, cell_height_ = 1;
  std::vector<Cell> cells_;
  std::vector<Entry> entries_;
  std::vector<Cells> cells_of_facet_;   ///< per facet
  std::vector<RoundedBounds> rounded_;  ///< per facet
  std::vector<double> farthest_;        ///< per facet
  std::vector<std::uint8_t> hidden_;

  /// Per facet, a linked list of the results of earlier comparisons with other facets: first, next.
  std::vector<std::uint32_t> judged_;
  std::vector<Judgement> judgements_;

  // Scratch memory: per facet, its place in the current cell; per place, layers as a union-find forest.
  std::vector<std::uint32_t> place_, stamp_;
  std::uint32_t stamp_now_ = 0;
  std::vector<std::uint32_t> parent_, covering_;
  std::vector<Found> found_;
  std::vector<std::uint8_t> broken_;  ///< per root of a layer: one of its silhouette edges may enter the cell
};

}  // namespace tubefoot
