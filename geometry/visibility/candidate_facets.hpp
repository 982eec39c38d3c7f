// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/search/height_fields.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/tubes/tube.hpp"
#include "geometry/visibility/edge_rings.hpp"

namespace tubefoot {

/// The facets that a run of neighbouring tubes may look at, gathered once for all of them, with what does not
/// depend on the tube: cones, distances, shared edges. Each tube then takes its own (admits()). What a tube
/// takes does not depend on the run that it was gathered with. Reused from run to run.
class CandidateFacets {
 public:
  /// A facet's box relative to the apex, in single precision, rounded outwards: {low x, y, z, high x, y, z}.
  using ReachBox = std::array<float, 6>;

  /// A tube's wall, for admits(): unit inward normal, and which ends of a box lie farthest inwards.
  struct Wall {
    std::array<double, 3> normal;
    std::array<std::uint8_t, 3> inner;
    explicit Wall(const Vec64& n);
  };

  /// Gathers for tubes [first, end). False if they had better be gathered apart (a single tube never is):
  /// they look at very many facets, or not all of them may see a height fields from above.
  bool gather(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes, std::uint32_t first,
              std::uint32_t end);

  /// Facets that subtend something, by increasing id.
  const std::vector<RangedFacet>& facets() const { return facets_; }
  const EdgeRings& rings() const { return rings_; }
  /// Facets that are known to be hidden by others, by increasing id; only the search for open water looks at
  /// them.
  const std::vector<FacetId>& hidden() const { return hidden_; }

  /// Law G1 (admission): false only if facet `f` has no vertex strictly inside some of the walls.
  bool admits(std::size_t f, const std::array<Wall, 4>& walls) const {
    // Coordinates below 2^31 times unit normals in double: far more than the rounding.
    constexpr double margin = -1e-5;
    const ReachBox& box = boxes_[f];
    for (const Wall& wall : walls)
      if (wall.normal[0] * box[wall.inner[0]] + wall.normal[1] * box[wall.inner[1]] +
              wall.normal[2] * box[wall.inner[2]] <
          margin)
        return false;
    return true;
  }

 private:
  std::vector<RangedFacet> facets_;
  std::vector<ReachBox> boxes_;
  EdgeRings rings_;
  std::vector<FacetId> candidates_, hidden_;
  std::array<std::vector<SceneTree::HalfSpace>, 4> walls_;  ///< wall k of each tube
  HeightFields::View sheets_;
};

}  // namespace tubefoot
