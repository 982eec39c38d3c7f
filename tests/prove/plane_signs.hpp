// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/tubes/tube.hpp"
#include "prove/random.hpp"

namespace tubefoot::prove {

/// The predicate on the planes of a scene. Three arithmetics and all their tiers must agree, and obey the
/// laws of a determinant.
class PlaneSigns {
 public:
  /// Checks some random triples of the walls of the tube, the edge planes of the facets and their depth
  /// planes. Also checks some random points against planes and facets.
  bool obey_laws(const FacetMesh& mesh, const TubeSet& tubes, std::uint32_t tube, Random& random);

 private:
  std::vector<FacetCone> cones_;
  std::vector<GridPoint> points_;
  std::vector<int> expected_, signs_;
};

}  // namespace tubefoot::prove
