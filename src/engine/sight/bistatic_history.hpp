// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/ground/paired_facet.hpp"
#include "geometry/footprints/shared_footprints.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/visibility/visibility.hpp"

// Transmitter and receiver apart. docs/bistatic.md
namespace tubefoot {

/// What one transmission met that a receiver elsewhere sees too. A path is transmit apex -> facet -> receive
/// apex, so a shared footprint is a path.
struct BistaticHistory {
  TubeSet transmit, receive;
  double grid_unit_m = 1;  ///< metres per grid unit of both
  SharedFootprints shared;
  /// In refracting water: by shared facet, where else it is seen and lies; empty: in even water.
  std::vector<PairedFacet> paired{};
};

/// What every tube of an apex sees. The result does not depend on the threads.
std::vector<TubeVisibility> look(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes,
                                 const VisibilityOptions& options);

/// Exact visibility from both apexes, and the exact intersections on the facets. `options` must name an exact
/// arithmetic. The result does not depend on the threads.
BistaticHistory trace_bistatic(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                               const VisibilityOptions& options, TubeSet transmit, TubeSet receive);

/// The same in refracting water, on facets that the two apexes see in different places (trees of the two
/// apparent meshes). Facets of the history are those of pair.mesh. `transmit` and `receive` are what the pair
/// was made with; both have the same reference speed.
BistaticHistory trace_bistatic(const ApparentPair& pair, const WorldGrid& grid,
                               const VisibilityOptions& options, TubeSet transmit, TubeSet receive,
                               const Straightening& transmit_water, const Straightening& receive_water,
                               double reference_absorption_db_per_m);

}  // namespace tubefoot
