// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/scattering/bistatic_facet.hpp"
#include "geometry/footprints/shared_footprints.hpp"
#include "geometry/search/scene_tree.hpp"
#include "geometry/visibility/visibility.hpp"

// Histories of a transmitter and a separate receiver. See docs/notes/bistatic.md.
namespace tubefoot {

class ApparentMap;
class WorldGrid;
struct ApparentPair;

/// A hit of a transmit ray that a separate receiver sees too. It represents the solid angle from which the
/// ray was drawn.
struct SharedHit {
  std::uint32_t seen = 0;  ///< number of its facet in SharedFootprints::facets
  std::uint32_t transmit_tube = 0, receive_tube = 0;
  double solid_angle_sr = 0;  ///< at the transmitter
  glm::dvec3 at_m{0};         ///< position that the transmitter sees, relative to the transmit apex
};

/// Footprints and hits of one transmission that a separate receiver sees too. A path is transmit apex ->
/// facet -> receive apex, so a shared footprint (or hit) is a path.
struct BistaticHistory {
  TubeSet transmit, receive;
  double grid_unit_m = 1;   ///< metres per grid unit of both
  SharedFootprints shared;  ///< for hits: their facets, without pieces
  /// In stratified water, per shared facet: its position for the receiver and its true position. Empty in
  /// isovelocity water.
  std::vector<BistaticFacet> bistatic{};
  std::vector<SharedHit> hits{};  ///< written by the ray engine
};

/// Returns the visible pieces of every tube of an apex. With plain double arithmetic contradictory pieces are
/// omitted. The result does not depend on the threads.
std::vector<TubeVisibility> look(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes,
                                 const VisibilityOptions& options);

/// Computes the visibility from both apexes and the exact intersections on the facets. The result does not
/// depend on the threads. `corner_rests`: as SharedDetails::corner_rests.
BistaticHistory trace_bistatic(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                               const VisibilityOptions& options, TubeSet transmit, TubeSet receive,
                               bool corner_rests = false);

/// The same in stratified water, for facets with different apparent positions for the two apexes (trees of
/// the two apparent meshes). Facets of the history are those of pair.mesh. `transmit` and `receive` are the
/// tubes with which the pair was constructed. Both have the same reference speed.
BistaticHistory trace_bistatic(const ApparentPair& pair, const WorldGrid& grid,
                               const VisibilityOptions& options, TubeSet transmit, TubeSet receive,
                               const ApparentMap& transmit_water, const ApparentMap& receive_water,
                               double reference_absorption_db_per_m);

}  // namespace tubefoot
