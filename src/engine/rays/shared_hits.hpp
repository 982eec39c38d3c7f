// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/rays/ray_engine.hpp"
#include "engine/visibility/bistatic_history.hpp"
#include "geometry/tubes/tube_finder.hpp"

// What two apexes share, sampled. docs/bistatic.md
namespace tubefoot {

/// One end of sampled paths: what an apex, or an image of it, looks at, and in which tubes. What is referred
/// to must outlive it.
struct SampledEnd {
  const RayScene& scene;
  const TubeSet& tubes;
  const TubeFinder& finder;  ///< of the tubes
  /// By facet of the scene: the facet of the mesh that both ends have in common; empty: itself.
  std::span<const FacetId> origin{};

  FacetId origin_of(FacetId facet) const { return origin.empty() ? facet : origin[facet]; }
};

/// Facets that each end sees in a place of its own (refracting water): by facet of the common mesh, the
/// receiver's. Both have the same vertices in the same order.
struct ApparentFacets {
  static constexpr FacetId none = no_point;
  std::vector<FacetId> received;
};

/// Of the hits of rays from `sent` (history.hits, whose tubes are numbers of sent.tubes), those that
/// `received` sees too: the same side of their facet, in one of its tubes (or one in each of several fans),
/// with nothing before them. `common` is the mesh of the origins; with `apparent`, places are carried over to
/// the receiver's facet, and planes are those that the transmitter sees. The result is the same for any
/// number of threads.
BistaticHistory shared_hits(const History& history, const SampledEnd& sent, const SampledEnd& received,
                            const FacetMesh& common, const ApparentFacets* apparent = nullptr);

}  // namespace tubefoot
