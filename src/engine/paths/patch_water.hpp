// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "engine/paths/visible_surface.hpp"

// Extends stratified water below the seabed for rays between places on the seabed, and counts their apparent
// maps. Source: docs/notes/multiple-paths.md, "Patches in stratified water".
namespace tubefoot {

/// Water column for rays from places on the seabed. Below `depth_m`, the depth of the lowest place, the
/// gradient continues over `further_m`. No sound propagates there. A ray thus leads from a place to each
/// place at the same depth, and a ray that starts into the seabed can be recognised.
WaterColumn continued_below(const WaterColumn& water, double depth_m, double further_m);

/// Sums of counts over several apparent maps (ApparentSurface).
struct SurfaceCounts {
  std::size_t facets = 0, in_shadow = 0, of_several = 0, folded = 0;
  double largest_travel_path_error_m = 0;
  std::vector<UnclearPlace> unclear{};  ///< first place without a ray, and first place with several rays

  void add(const SurfaceCounts& more);
};

/// Counts of the apparent map of an apex on the seabed, except for folded facets. A facet without a ray
/// counts if a corner lies more than `before_m` in front of the plane through the apex with the normal
/// `front`. With `front` = 0 each such facet counts.
SurfaceCounts counts_from(const ApparentSurface& surface_mesh, const ApparentMap& water, glm::dvec3 front,
                          double before_m);

/// Number of facets that the apex sees from the side on which the rays do not arrive. Facets seen edge-on do
/// not count, because the travel-path error alone may turn them over.
std::size_t folded_facets(const VisibleSurface& seabed);

}  // namespace tubefoot
