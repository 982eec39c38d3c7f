// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "engine/paths/visible_surface.hpp"

// Water that refracts, for places on a seabed that see each other through it. docs/paths.md
namespace tubefoot {

/// The same water for places on a seabed: below the seabed's lowest place, where no sound is, speeds go on as
/// above it for `further_m`, so that a ray leads from a place to all that are level with it, and it can be
/// told that it is sent into the seabed.
WaterColumn continued_below(const WaterColumn& water, double depth_m, double further_m);

/// What came of several apparent maps, counted (ApparentSurface).
struct SurfaceCounts {
  std::size_t facets = 0, in_shadow = 0, of_several = 0, folded = 0;
  double largest_travel_path_error_m = 0;
  std::vector<UnclearPlace> unclear{};  ///< the first without a ray, and the first with several

  void add(const SurfaceCounts& more);
};

/// Of what an apex on the seabed has mapped, but for folded facets. A place without a ray counts if it
/// lies more than `before_m` before the plane that `front` is the normal of; 0: everywhere.
SurfaceCounts counts_from(const ApparentSurface& surface_mesh, const ApparentMap& water, glm::dvec3 front,
                          double before_m);

/// How many facets are seen from the other side than rays come to; not of those that are seen edge-on, which
/// the gap alone may turn over.
std::size_t folded_facets(const VisibleSurface& seabed);

}  // namespace tubefoot
