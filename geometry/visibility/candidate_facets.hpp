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

/// The candidate facets of a run of neighbouring tubes, collected once for all of them. The object stores all
/// data that do not depend on the tube: cones, distances, shared edges. Each tube selects its own facets with
/// admits(). This selection does not depend on the run. The object is reused from run to run.
class CandidateFacets {
 public:
  /// A facet's box relative to the apex, in single precision, rounded outwards: {low x, y, z, high x, y, z}.
  using ReachBox = std::array<float, 6>;

  /// A tube's wall, for admits(): the unit inward normal, and the ends of a box that lie farthest inwards.
  struct Wall {
    std::array<double, 3> normal;
    std::array<std::uint8_t, 3> inner;
    explicit Wall(const Vec64& n);
  };

  /// Collects the facets for tubes [first, end). Returns false if the tubes should be processed separately.
  /// The reason can be a very large number of facets, or a height field that not all tubes may see from
  /// above. A single tube always succeeds.
  bool gather(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes, std::uint32_t first,
              std::uint32_t end);

  /// Facets that subtend something, by increasing id.
  const std::vector<RangedFacet>& facets() const { return facets_; }
  const EdgeRings& rings() const { return rings_; }
  /// Facets that other facets are known to hide, by increasing id. Only the search for the unobstructed
  /// region uses them.
  const std::vector<FacetId>& hidden() const { return hidden_; }

  /// Law G1 (admission): returns false only if facet `f` has no vertex strictly inside some of the walls.
  bool admits(std::size_t f, const std::array<Wall, 4>& walls) const {
    // The products are coordinates below 2^31 times unit normals in double. The margin is far larger than
    // their rounding errors.
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
