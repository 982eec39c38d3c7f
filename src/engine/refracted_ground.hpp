// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geometry/edge_refinement.hpp"
#include "medium/straightening.hpp"

// What one apex sees through refracting water, as a mesh of apparent facets that straight tubes see.
// docs/physics.md, "Straightening"
namespace tubefoot {

struct StraighteningSettings {
  /// Edges are cut until the image of their middle is as close as this to the middle of their ends' images.
  double gap_m = 1e-3;
  /// None shorter than this is cut: next to a caustic the gap does not shrink.
  double shortest_edge_m = 0.05;
  /// Edges in a shadow, or at its border, are cut down to this: facets at the border are left out whole.
  double shadow_edge_m = 4;
};

/// A place that has not exactly one eigenray.
struct UnclearPlace {
  FacetId facet = 0;  ///< of the base
  glm::dvec3 at_m{0};
  int eigenrays = 0;        ///< 0: shadow
  glm::dvec3 direction{0};  ///< launch direction of the first to arrive; straight to the place in a shadow
};

struct ApparentGround {
  /// Apparent facets that have an eigenray to every corner and their centre, and the base facet of each.
  RefinedMesh refined;
  std::vector<double> facet_factor;  ///< for EchoLaw::facet_factor
  double reference_speed_m_s = 0;    ///< by which a travel time becomes a range
  double largest_gap_m = 0;          ///< of all edges that are left
  std::size_t facets_in_shadow = 0;  ///< left out: they lie, wholly or in part, where no ray leads
  /// For each base facet: a place of it in a shadow, and one where rays cross, if it has such.
  std::vector<UnclearPlace> unclear;
};

/// Straightens `facets` of `base` for one apex. `reference_absorption_db_per_m` is what the echo law will
/// apply to apparent ranges. Apparent points have to fit `grid`. The result does not depend on the number of
/// threads. Throws as refine(); std::invalid_argument unless the settings are above 0.
ApparentGround straighten(const FacetMesh& base, std::span<const FacetId> facets, const WorldGrid& grid,
                          const Straightening& straightening, double reference_absorption_db_per_m,
                          const StraighteningSettings& settings, const RefinementLimits& limits = {});

}  // namespace tubefoot
