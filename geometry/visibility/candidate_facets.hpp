// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/search/height_fields.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/visibility/front.hpp"

namespace tubefoot {

/// The candidate facets of a pyramid of tubes, with the data that do not depend on its rays: cones,
/// distances, shared edges. The object is reused from pyramid to pyramid.
class CandidateFacets {
 public:
  /// A facet's box relative to the apex, in single precision, rounded outwards: {low x, y, z, high x, y, z}.
  using ReachBox = std::array<float, 6>;

  /// A wall of the pyramid, for admits(): the unit inward normal, and the ends of a box that lie farthest
  /// inwards.
  struct Wall {
    std::array<double, 3> normal;
    std::array<std::uint8_t, 3> inner;
    explicit Wall(const Vec64& n);
  };

  /// Collects the facets within a pyramid of rays. With `only_front`, facets are omitted if nearer facets
  /// certainly hide them, and omitting them changes no visible region.
  void gather(const FacetMesh& mesh, const SceneTree& tree, GridPoint apex, double reach,
              const std::array<GridPoint, 4>& rays, bool only_front);

  /// Facets that subtend something, by increasing id.
  const std::vector<RangedFacet>& facets() const { return facets_; }
  /// Finds the neighbours of some of these facets: EdgeRings::find_neighbours().
  void find_neighbours(const std::vector<std::uint32_t>& chosen, std::uint32_t crowd,
                       std::vector<Neighbours>& neighbours, std::vector<std::uint8_t>& crowded) {
    rings_.find_neighbours(facets_, chosen, crowd, neighbours, crowded);
  }
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
  void make_facets(const FacetMesh& mesh, const HeightFields* sheets, GridPoint apex, double reach);

  std::vector<RangedFacet> facets_;
  std::vector<ReachBox> boxes_;
  EdgeRings rings_;
  std::vector<FacetId> candidates_, hidden_;
  HeightFields::View sheets_;
  Front front_;
};

}  // namespace tubefoot
