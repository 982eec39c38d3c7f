// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/rays/ray_engine.hpp"
#include "engine/visibility/bistatic_history.hpp"
#include "geometry/tubes/tube_finder.hpp"

// Common visibility of two apexes, computed from sampled rays. See docs/notes/bistatic.md.
namespace tubefoot {

/// One end of sampled paths: the scene that an apex or an image of it sees, and its tubes. All referenced
/// objects must outlive it.
struct SampledEnd {
  const RayScene& scene;
  const TubeSet& tubes;
  const TubeFinder& finder;  ///< for these tubes
  /// Per facet of the scene: the corresponding facet of the mesh that both ends have in common; empty: the
  /// same facet.
  std::span<const FacetId> origin{};

  FacetId origin_of(FacetId facet) const { return origin.empty() ? facet : origin[facet]; }
};

/// Facets that each end sees at its own apparent position (stratified water). Per facet of the common mesh:
/// the receiver's facet. Both have the same vertices in the same order.
struct ApparentFacets {
  static constexpr FacetId none = no_point;
  std::vector<FacetId> received;
};

/// Selects the hits of rays from `sent` that `received` sees too. The tubes of history.hits are numbers of
/// sent.tubes. The receiver must see the same side of the facet with no facet in between. The point must lie
/// in one of its tubes, or in one of each of several fans. `common` is the mesh of the origins. With
/// `apparent`, points are mapped to the receiver's facet, and planes are those that the transmitter sees. The
/// result is the same for any number of threads.
BistaticHistory shared_hits(const History& history, const SampledEnd& sent, const SampledEnd& received,
                            const FacetMesh& common, const ApparentFacets* apparent = nullptr);

}  // namespace tubefoot
