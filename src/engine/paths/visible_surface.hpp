// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "engine/scattering/facet_map.hpp"
#include "engine/surface/refracted_surface.hpp"
#include "geometry/footprints/shared_footprints.hpp"

namespace tubefoot {

/// A part of a facet that is seen elsewhere than where it lies, and the rays to it. Places are relative to
/// the apex that sees it. The end of a receiver pair sees the seabed where its middle does, whose rays are
/// its own but for direction and range, which are from the end.
struct RefractedFacet {
  FacetMap lies;          ///< from where places are seen to where they lie
  FacetMap seen;          ///< and back
  FacetMap parts;         ///< from where they lie to how far towards the second corner (x) and the third (y)
  glm::dvec3 normal{0};   ///< of where it lies: unit, to the side at which rays arrive
  double area_ratio = 1;  ///< of where it lies over where it is seen

  /// What the straight law does not know of the ray to a place: that law is right in direction and time.
  struct Ray {
    double bend = 0;      ///< sine of the grazing angle, less that of the direction of launch
    double tx = 1;        ///< energy a square metre, per steradian at the apex
    double rx = 1;        ///< the same from the place back to the apex
    double absorbed = 1;  ///< absorption alone; also part of the two above
  };
  std::array<Ray, 3> corners;

  /// As it lies between the corners.
  Ray ray_to(glm::dvec3 lies_m) const;
  /// Sine of the grazing angle; below 0 behind the facet.
  double sine(glm::dvec3 seen_m, const Ray& ray) const;
};

/// As it is seen from `apex_m`, which is the water's apex or beside it. All places in the local frame;
/// `rays`: from the water's apex to where the corners lie.
RefractedFacet refracted_facet(glm::dvec3 apex_m, const glm::dvec3 (&seen_m)[3],
                               const glm::dvec3 (&lies_m)[3], const Eigenray (&rays)[3],
                               const ApparentMap& water, double reference_absorption_db_per_m);

/// What an image sees of the seabed.
struct VisibleSurface {
  SharedFootprints shared;                  ///< with itself, where it is seen; facets are named by the seabed
  std::vector<RefractedFacet> refracted{};  ///< by facet there; empty: all lies where it is seen

  const RefractedFacet* refracted_of(const SharedFacet& facet) const {
    return refracted.empty() ? nullptr : &refracted[static_cast<std::size_t>(&facet - shared.facets.data())];
  }
};

}  // namespace tubefoot
