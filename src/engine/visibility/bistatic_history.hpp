// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/surface/bistatic_facet.hpp"
#include "geometry/footprints/shared_footprints.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/visibility/visibility.hpp"

// Transmitter and separate receiver. docs/bistatic.md
namespace tubefoot {

/// A ray's hit that a receiver elsewhere sees, standing for the solid angle it was drawn from.
struct SharedHit {
  std::uint32_t seen = 0;  ///< number of its facet in SharedFootprints::facets
  std::uint32_t transmit_tube = 0, receive_tube = 0;
  double solid_angle_sr = 0;  ///< at the transmitter
  glm::dvec3 at_m{0};         ///< where the transmitter sees it, relative to the transmit apex
};

/// What one transmission met that a receiver elsewhere sees too. A path is transmit apex -> facet -> receive
/// apex, so a shared footprint (or hit) is a path.
struct BistaticHistory {
  TubeSet transmit, receive;
  double grid_unit_m = 1;   ///< metres per grid unit of both
  SharedFootprints shared;  ///< of hits: their facets, without pieces
  /// In refracting water: by shared facet, where else it is seen and lies; empty: in isovelocity water.
  std::vector<BistaticFacet> bistatic{};
  std::vector<SharedHit> hits{};  ///< filled by the ray engine
};

/// What every tube of an apex sees; by plain double arithmetic, without its contradictions. The result does
/// not depend on the threads.
std::vector<TubeVisibility> look(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes,
                                 const VisibilityOptions& options);

/// Visibility from both apexes, and the exact intersections on the facets. The result does not depend on the
/// threads.
BistaticHistory trace_bistatic(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                               const VisibilityOptions& options, TubeSet transmit, TubeSet receive);

/// The same in refracting water, on facets that the two apexes see in different places (trees of the two
/// apparent meshes). Facets of the history are those of pair.mesh. `transmit` and `receive` are what the pair
/// was made with; both have the same reference speed.
BistaticHistory trace_bistatic(const ApparentPair& pair, const WorldGrid& grid,
                               const VisibilityOptions& options, TubeSet transmit, TubeSet receive,
                               const ApparentMap& transmit_water, const ApparentMap& receive_water,
                               double reference_absorption_db_per_m);

}  // namespace tubefoot
