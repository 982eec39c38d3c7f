// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "engine/rays/ray_lanes.hpp"
#include "engine/visibility/history.hpp"
#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

/// Intersects rays with the planes of their facets in double. Embree's float only selects the facet.
class RayPlanes {
 public:
  RayPlanes() = default;
  /// `mesh` must outlive the object.
  RayPlanes(const FacetMesh& mesh, double unit_m);

  /// Sets range and grazing angle of `hit`, which must have its facet. Returns false if the facet's plane
  /// contains the apex.
  bool meet(GridPoint apex, glm::dvec3 direction, double embree_range_m, RayHit& hit) const;
  /// The same for a packet. Uncertain rays are marked and must be computed one by one. For lanes without a
  /// hit, `facet` must be the number of an arbitrary existing facet.
  void meet(GridPoint apex, const RayPacket& rays, const std::array<FacetId, RayPacket::size>& facet,
            const float* embree_range_m, MetPlanes& met) const;

 private:
  /// Rounded from the exact integers.
  RayPlane plane_of(FacetId facet) const;

  const FacetMesh* mesh_ = nullptr;
  double unit_m_ = 1;
  std::vector<RayPlane> planes_;
};

}  // namespace tubefoot
