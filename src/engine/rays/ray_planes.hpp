// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "engine/rays/ray_lanes.hpp"
#include "engine/visibility/history.hpp"
#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

/// Where rays meet the planes of their facets, in double: Embree's float only says which facet.
class RayPlanes {
 public:
  RayPlanes() = default;
  /// `mesh` must outlive this.
  RayPlanes(const FacetMesh& mesh, double unit_m);

  /// Sets range and grazing angle of `hit`, which has its facet already; false if its plane holds the apex.
  bool meet(GridPoint apex, glm::dvec3 direction, double embree_range_m, RayHit& hit) const;
  /// The same of a packet, but for rays that are in ambiguity: those have to be asked for alone. Of lanes
  /// that met nothing, `facet` must be the number of some facet all the same.
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
