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

/// Parts of a mesh that are proven to be graphs of a height: no vertical line meets them twice. A seabed is
/// one, whatever its roughness. Seen from above, nobody sees the facets of such a sheet that face away: on
/// every ray the sheet's own front comes first. The proof is exact and made once; docs/visibility.md has it.
class HeightFields {
 public:
  static constexpr std::uint16_t none = std::numeric_limits<std::uint16_t>::max();
  /// Smaller sheets are not worth their bookkeeping.
  static constexpr std::size_t fewest_facets = 32;

  explicit HeightFields(const FacetMesh& mesh);
  ~HeightFields();

  std::size_t count() const { return turn_.size(); }
  /// The sheet that a facet belongs to, or `none`.
  /// Law H1 (graph): no vertical line meets a sheet twice.
  std::uint16_t height_field_of(FacetId facet) const {
    return height_field_.empty() ? none : height_field_[facet];
  }

  /// What one view of the sheets needs; kept from view to view.
  struct View {
    std::vector<std::uint8_t> from_above;  ///< by sheet
    std::vector<FacetId> found;
  };

  /// Fills view.from_above with 1 for each sheet of which it is certain that every ray of a tube from the
  /// apex meets it, if at all within `reach`, first from above. `rays` and `half_spaces` are the tube's, in
  /// its order; `tree` is that of the sheets' mesh. What is beyond the reach changes nothing, and nothing is
  /// said of facets that are not wholly within it.
  void look(const FacetMesh& mesh, const SceneTree& tree, GridPoint apex,
            const std::array<GridPoint, 4>& rays, std::span<const SceneTree::HalfSpace> half_spaces,
            double reach, View& view) const;

  /// The same for several tubes at once, `walls` being all of theirs: false if they may differ in what they
  /// see from above.
  bool look_over(const FacetMesh& mesh, const SceneTree& tree, GridPoint apex,
                 std::span<const SceneTree::Fan> walls, double reach, View& view) const;

  /// True for a facet that nobody sees in that view: of a sheet seen from above, it turns its lower side (or
  /// its edge) to the apex. `cone`: the facet's, null if it subtends nothing. Exact.
  /// Law H2 (leaving out): leaving out facets of which this is true changes nothing that is seen.
  bool surely_hidden(FacetId facet, const FacetCone* cone, const View& view) const {
    const std::uint16_t height_field = height_field_[facet];
    if (height_field == none || !view.from_above[height_field]) return false;
    // A cone's corners turn left for the apex; a sheet's facets turn right for one that is above them.
    return !cone || cone->reversed != (turn_[height_field] > 0);
  }

  std::size_t bytes() const;

 private:
  void look_down(const FacetMesh& mesh, const SceneTree& tree, GridPoint apex, View& view) const;

  std::vector<std::uint16_t> height_field_;  ///< by facet; empty if there is no sheet
  std::vector<std::int8_t> turn_;  ///< by sheet: +1 if its facets' corners turn left in the plan, -1 right
  FacetMesh curtains_;             ///< a facet hung below each border edge, its component being the sheet
  std::unique_ptr<SceneTree> curtain_tree_;
};

}  // namespace tubefoot
