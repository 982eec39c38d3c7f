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

/// Bounding-box tree of the facets of a mesh. A query finds the facets that may meet a pyramid of planes
/// through an apex within a reach. The tree has 32 bytes per node and eight facets per leaf. CGAL's AABB_tree
/// stores points and boxes in double and returns one facet at a time; this tree needs a third of its memory
/// (docs/visibility.md). If a facet has many copies, the tree may contain only the first, which wins ties.
class SceneTree {
 public:
  enum class HeightFieldSearch { proven, ignored };

  /// `height_fields` selects whether to search for height fields too.
  explicit SceneTree(const FacetMesh& mesh, HeightFieldSearch height_fields = HeightFieldSearch::proven);
  /// Adds facets to a tree, for example moving facets to those at rest. `at_rest` contains the first facets
  /// of the mesh, and this tree the facets from `first_moving`. A query visits both trees. The mesh of
  /// `at_rest` must outlive this tree and may be another one with the same first facets. Height fields are
  /// those of `at_rest`; facets from `first_moving` belong to none.
  ///
  /// Law T2 (two levels): queries with half-spaces find the same facets as in one tree of the mesh,
  /// except copies.
  SceneTree(const FacetMesh& mesh, std::shared_ptr<const SceneTree> at_rest, FacetId first_moving);

  /// A half-space through the apex: directions d with normal . d >= 0. The test is made up to rounding,
  /// because it serves only as a filter.
  struct HalfSpace {
    double x, y, z;
  };

  /// Appends to `out`, in no particular order, every facet whose box meets all half-spaces and is nearer to
  /// the apex than `reach` (grid units).
  ///
  /// Law T1 (candidates): the result contains all facets that meet the pyramid, and may contain others.
  void query(GridPoint apex, std::span<const HalfSpace> half_spaces, double reach,
             std::vector<FacetId>& out) const {
    query(apex, half_spaces, reach, 0, out);
  }
  /// The same for boxes enlarged by `margin` (grid units) on all sides. The result contains the facets that
  /// may meet the pyramid after a displacement by up to `margin`.
  void query(GridPoint apex, std::span<const HalfSpace> half_spaces, double reach, double margin,
             std::vector<FacetId>& out) const;
  /// Returns a bound on the number of facets that the query finds. Boxes wholly inside the pyramid are not
  /// opened, so the work grows with the boxes on its border.
  std::size_t count(GridPoint apex, std::span<const HalfSpace> half_spaces, double reach) const;

  /// Returns whether a box at a distance from the apex may contain facets that the caller needs.
  using NeedsBox = std::function<bool(const GridPoint& lowest, const GridPoint& highest, double distance)>;

  /// Does the same as the first query in order of the distance of boxes from the apex, except for boxes that
  /// `needs` rejects. `needs` is called for nested boxes, down to boxes of a few facets, and `out` then
  /// contains the facets of nearer boxes.
  void query_by_distance(GridPoint apex, std::span<const HalfSpace> half_spaces, double reach,
                         const NeedsBox& needs, std::vector<FacetId>& out) const;

  /// Appends all facets except those in boxes that `may_meet` rejects. `may_meet` is called for nested boxes,
  /// down to boxes of a few facets.
  void query(const std::function<bool(const GridPoint& lowest, const GridPoint& highest)>& may_meet,
             std::vector<FacetId>& out) const;

  /// Returns null if there are none.
  const HeightFields* height_fields() const { return height_fields_.get(); }

  std::size_t bytes() const;

 private:
  struct Box {
    GridPoint lo, hi;
  };
  /// Nodes in depth-first order: the first child of an inner node follows it, and its second child is at
  /// `link`. A leaf contains the facets order_[link, link + count).
  struct Node {
    Box box;
    std::uint32_t link = 0, count = 0;
  };

  class PyramidTest;

  void build(FacetId first_facet);
  void take_leaf(const Node& leaf, const PyramidTest& test, unsigned checks, std::vector<FacetId>& out) const;

  const FacetMesh* mesh_;
  std::vector<Node> nodes_;
  std::vector<FacetId> order_;
  std::shared_ptr<const HeightFields> height_fields_;
  std::shared_ptr<const SceneTree> at_rest_;  ///< null if this tree contains all facets
};

}  // namespace tubefoot
