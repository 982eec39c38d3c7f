// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

class HeightFields;

/// Bounding-box tree over the facets of a mesh, asked for the facets that may meet a pyramid of planes
/// through an apex, within a reach. 32 bytes a node, eight facets a leaf. (CGAL's AABB_tree holds points and
/// boxes in double and answers one facet at a time; this one needs a third of its memory:
/// docs/visibility.md.) Of many copies of a facet it may hold only the first, which wins their ties.
class SceneTree {
 public:
  enum class HeightFieldSearch { proven, ignored };

  /// `height_fields`: whether to look for height fields too.
  explicit SceneTree(const FacetMesh& mesh, HeightFieldSearch height_fields = HeightFieldSearch::proven);

  /// A half-space through the apex: directions d with normal . d >= 0 (to within rounding: a filter, not a
  /// verdict).
  struct HalfSpace {
    double x, y, z;
  };

  /// Several half-spaces of which a box has to meet one: those of a wall as it turns from tube to tube.
  class Fan {
   public:
    Fan() = default;
    explicit Fan(std::span<const HalfSpace> half_spaces);

   private:
    friend class SceneTree;
    HalfSpace first{}, last{}, middle{};
    HalfSpace spread{};  ///< no normal differs from the middle one by more, in each coordinate
  };

  /// Appends to `out`, in no particular order, every facet whose box meets all half-spaces and comes nearer
  /// to the apex than `reach` (grid units).
  /// Law T1 (candidates): facets that do not meet the pyramid may be among them; none that does is missing.
  void query(GridPoint apex, std::span<const HalfSpace> half_spaces, double reach,
             std::vector<FacetId>& out) const;
  /// The same for boxes made larger by `margin` (grid units) on all sides: facets that may meet the pyramid
  /// when they are moved by as much.
  void query(GridPoint apex, std::span<const HalfSpace> half_spaces, double reach, double margin,
             std::vector<FacetId>& out) const;
  /// The same with fans: no facet is missing whose box truly meets one half-space of each.
  void query(GridPoint apex, std::span<const Fan> fans, double reach, std::vector<FacetId>& out) const;

  /// Appends every facet, but for those in boxes that `may_meet` refuses: it is asked of boxes within boxes,
  /// down to those of a few facets.
  void query(const std::function<bool(const GridPoint& lowest, const GridPoint& highest)>& may_meet,
             std::vector<FacetId>& out) const;

  /// Null if there are none.
  const HeightFields* height_fields() const { return height_fields_.get(); }

  std::size_t bytes() const;

 private:
  struct Box {
    GridPoint lo, hi;
  };
  /// Depth first: an inner node's first child follows it, its second child is at `link`. A leaf holds the
  /// facets order_[link, link + count).
  struct Node {
    Box box;
    std::uint32_t link = 0, count = 0;
  };

  template <class Side>
  void query_sides(GridPoint apex, std::span<const Side> sides, double reach, double margin,
                   std::vector<FacetId>& out) const;

  const FacetMesh* mesh_;
  std::vector<Node> nodes_;
  std::vector<FacetId> order_;
  std::shared_ptr<const HeightFields> height_fields_;
};

}  // namespace tubefoot
