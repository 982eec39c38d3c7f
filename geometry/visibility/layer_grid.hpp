// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/numbers/lane_bits.hpp"
#include "geometry/visibility/gnomonic_frame.hpp"

namespace tubefoot {

/// What lies beyond an edge of a facet, as seen from the apex.
constexpr std::int32_t silhouette = -1;    ///< nothing, a fold, or more than one facet
constexpr std::int32_t outside_tube = -2;  ///< whatever it is, the edge does not enter the tube

/// Neighbours across the three edges: a facet's index, silhouette or outside_tube. Edge k runs from vertex k
/// to k + 1.
using Neighbours = std::array<std::int32_t, 3>;

/// Finds out, without a single exact predicate, which facets of a tube are surely hidden, and which pairs
/// need a closer look.
///
/// The argument (docs/visibility.md, 'Layers'). Cut the gnomonic plane into cells. In each, the facets joined
/// by shared edges form layers. A layer none of whose silhouette edges enters the cell covers every point of
/// the cell (within the tube) equally often: stepping over a shared edge leaves one facet and enters one. So
/// one point decides: a layer that covers it hides whatever lies wholly beyond the layer's farthest facet; a
/// layer that covers it once does not overlap itself anywhere in the cell.
class LayerGrid {
 public:
  /// Facets and neighbours are indexed alike and must outlive the grid's use.
  void build(const GnomonicFrame& frame, const std::vector<FramedFacet>& facets,
             const std::vector<Neighbours>& neighbours);

  /// Law L1 (hidden): true only if no part of the facet is seen; then it hides nothing that others do not.
  bool is_hidden(std::uint32_t facet) const { return hidden_[facet] != 0; }

  /// Law L2 (occluders): fills `out` with every facet that might hide part of `facet`, not being surely apart
  /// from it, and is not hidden itself, nearest first.
  void occluder_candidates(std::uint32_t facet, std::vector<std::uint32_t>& out);

 private:
  struct Cells {
    int x0, x1, y0, y1;
  };
  /// Bounds in single precision, rounded outwards.
  struct RoundedBounds {
    FourFloats ends;  ///< x0, y0, -x1, -y1
    explicit RoundedBounds(const Bounds& b);
    /// The largest ends that bounds may have that meet these.
    FourFloats reach() const { return -__builtin_shufflevector(ends, ends, 2, 3, 0, 1); }
    bool within(const FourFloats& reach) const { return bits_of(FourLanes(ends <= reach)) == 0b1111; }
  };
  struct Cell {
    std::uint32_t begin = 0, end = 0;  ///< in entries_
    bool has_simple_layer = false;
    bool is_simple_layer = false;  ///< all entries left are of one simple layer
    /// Everything wholly beyond this distance is hidden here.
    double closed_beyond = std::numeric_limits<double>::infinity();
  };
  struct Entry {
    double nearest;  ///< of the facet; a cell's entries are sorted by it
    std::uint32_t facet;
    std::int32_t simple_layer;  ///< layer that covers this cell exactly once, by its root; or no_layer
    RoundedBounds bounds;       ///< of the facet, here because every pair of a cell is asked for them
  };
  static constexpr std::int32_t no_layer = -1, own_layer_is_none = -2;
  struct Found {
    double nearest;
    std::uint32_t facet;
    bool overlaps;  ///< known not to be apart
  };
  /// What was found when `facet` was looked at.
  struct Judgement {
    std::uint32_t facet, next;
    bool apart;
  };
  static constexpr std::uint32_t no_more = 0xffffffffu;

  void choose_size();
  Cells cells_of(const Bounds& bounds) const;
  Bounds bounds_of(int x, int y) const;
  void fill();
  bool has_silhouette_in(std::uint32_t facet, const Bounds& cell) const;
  void find_layers(int x, int y);
  bool find_layers(Cell& cell, const Bounds& box, std::uint32_t begin, std::uint32_t end);
  void find_hidden();
  void drop_hidden();

  const GnomonicFrame* frame_ = nullptr;
  const std::vector<FramedFacet>* facets_ = nullptr;
  const std::vector<Neighbours>* neighbours_ = nullptr;
  int columns_ = 1, rows_ = 1;
  double cell_width_ = 1, cell_height_ = 1;
  std::vector<Cell> cells_;
  std::vector<Entry> entries_;
  std::vector<Cells> cells_of_facet_;   ///< by facet
  std::vector<RoundedBounds> rounded_;  ///< by facet
  std::vector<double> farthest_;        ///< by facet
  std::vector<std::uint8_t> hidden_;

  /// By facet, a list of what was found of it when other facets were looked at: first, next.
  std::vector<std::uint32_t> judged_;
  std::vector<Judgement> judgements_;

  // Scratch: per facet, its place in the cell at hand; per place, layers as a union-find forest.
  std::vector<std::uint32_t> place_, stamp_;
  std::uint32_t stamp_now_ = 0;
  std::vector<std::uint32_t> parent_, covering_;
  std::vector<Found> found_;
  std::vector<std::uint8_t> broken_;  ///< by a layer's root: one of its silhouette edges may enter the cell
};

}  // namespace tubefoot
