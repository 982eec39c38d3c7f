// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/visibility/edge_rings.hpp"
#include "geometry/visibility/layer_grid.hpp"

namespace tubefoot {

/// The front of a pyramid: the parts of its directions that facets found so far cover, and the distances
/// beyond which these facets hide everything. The object is reused.
class Front {
 public:
  /// Finds the parts that `facets` cover. The shared edges are those of `rings`.
  void build(const std::array<GridPoint, 4>& rays, const std::vector<RangedFacet>& facets, EdgeRings& rings);

  /// Returns true only if the facets of build() hide everything in a box within the pyramid. The box has
  /// coordinates relative to the apex and is at least `distance` away from it.
  bool hides(GridPoint lowest, GridPoint highest, double distance) const;

 private:
  GnomonicFrame frame_;
  std::vector<FramedFacet> facets_;
  std::vector<std::uint32_t> all_;
  std::vector<Neighbours> neighbours_;
  std::vector<std::uint8_t> crowded_;
  LayerGrid grid_;
};

}  // namespace tubefoot
