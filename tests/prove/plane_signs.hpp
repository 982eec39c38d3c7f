// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/tubes/tube.hpp"
#include "prove/random.hpp"

namespace tubefoot::prove {

/// The one predicate on the planes of a scene: three arithmetics and all their tiers, one sign, and the
/// laws of a determinant.
class PlaneSigns {
 public:
  /// Some random triples of the tube's walls, the facets' edge planes and their depth planes, and some random
  /// points against planes and facets.
  bool obey_laws(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t tube, Random& random);

 private:
  std::vector<FacetCone> cones_;
  std::vector<GridPoint> points_;
  std::vector<int> expected_, signs_;
};

}  // namespace tubefoot::prove
