// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/search/scene_tree.hpp"

namespace tubefoot {

/// Parts of a mesh that are proven to be height fields: no vertical line meets such a part twice. Every
/// seabed without overhangs is a height field. From above, the facets of a height field that face away are
/// never visible. On every ray a front facet of the same part comes first. The proof is exact and made once
/// (docs/notes/visibility.md).
class HeightFields {
 public:
  static constexpr std::uint16_t none = std::numeric_limits<std::uint16_t>::max();
  /// Smaller parts are not worth the overhead.
  static constexpr std::size_t fewest_facets = 32;

  explicit HeightFields(const FacetMesh& mesh);
  ~HeightFields();

  std::size_t count() const { return turn_.size(); }
  /// Returns the index of the height field of a facet, or `none`. Facets beyond those of the mesh, which a
  /// tree of two levels adds, belong to none.
  ///
  /// Law H1 (graph): no vertical line meets a height field twice.
  std::uint16_t height_field_of(FacetId facet) const {
    return facet < height_field_.size() ? height_field_[facet] : none;
  }

  /// State of one view of the height fields, reused from view to view.
  struct View {
    std::vector<std::uint8_t> from_above;  ///< per height field
    std::vector<FacetId> found;
  };

  /// Sets view.from_above to 1 for each height field that is certainly met from above. This means that every
  /// ray of a tube from the apex that meets it within `reach` meets it first from above. `rays` and
  /// `half_spaces` are those of the tube, in its order; `tree` contains all facets of the height fields.
  /// Parts beyond the reach have no influence. The result holds only for facets that lie wholly within the
  /// reach.
  void look(const FacetMesh& mesh, const SceneTree& tree, GridPoint apex,
            const std::array<GridPoint, 4>& rays, std::span<const SceneTree::HalfSpace> half_spaces,
            double reach, View& view) const;

  /// Returns true for a facet that is not visible in that view. It belongs to a height field seen from above
  /// and turns its lower side or its edge to the apex. `cone` is the facet's cone, or null if the facet
  /// subtends nothing. Exact.
  ///
  /// Law H2 (leaving out): removing facets for which this is true does not change the visible polygons.
  bool surely_hidden(FacetId facet, const FacetCone* cone, const View& view) const {
    const std::uint16_t height_field = height_field_of(facet);
    if (height_field == none || !view.from_above[height_field]) return false;
    // The corners of a cone turn left for the apex. The facets of a height field turn right for an apex above
    // them.
    return !cone || cone->reversed != (turn_[height_field] > 0);
  }

  std::size_t bytes() const;

 private:
  void look_down(const FacetMesh& mesh, const SceneTree& tree, GridPoint apex, View& view) const;

  std::vector<std::uint16_t> height_field_;  ///< per facet; empty if there is no height field
  std::vector<std::int8_t>
      turn_;  ///< per height field: +1 if its facets' corners turn left in the plan, -1 if they turn right
  FacetMesh
      curtains_;  ///< a vertical facet below each border edge; its component is the index of the height field
  std::unique_ptr<SceneTree> curtain_tree_;
};

}  // namespace tubefoot
