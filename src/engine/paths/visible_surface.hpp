// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "engine/scattering/facet_map.hpp"
#include "engine/surface/refracted_surface.hpp"
#include "engine/water/eigenray.hpp"
#include "geometry/footprints/shared_footprints.hpp"

namespace tubefoot {

/// Part of a facet with its apparent position, and the rays to it. Places are relative to the apex that sees
/// the part. The end of a receiver pair sees the apparent seabed of the pair's middle. For this end,
/// direction and range are computed from the end, and all other properties of the rays are those of the
/// middle.
struct RefractedFacet {
  FacetMap lies;          ///< maps apparent to true positions
  FacetMap seen;          ///< maps true to apparent positions
  FacetMap parts;         ///< maps true positions to fractions towards the second (x) and third (y) corner
  glm::dvec3 normal{0};   ///< unit normal at the true position, to the side at which rays arrive
  double area_ratio = 1;  ///< true area divided by apparent area

  /// Corrections of the ray to a place relative to straight propagation. Direction and time need no
  /// correction.
  struct Ray {
    double bend = 0;      ///< sine of the grazing angle minus that of the launch direction
    double tx = 1;        ///< energy per m² and steradian at the apex, relative to a straight path
    double rx = 1;        ///< the same from the place back to the apex
    double absorbed = 1;  ///< factor of absorption alone; also part of tx and rx
  };
  std::array<Ray, 3> corners;

  /// Corrections at a place, interpolated linearly between the corners.
  Ray ray_to(glm::dvec3 lies_m) const;
  /// Sine of the grazing angle, negative behind the facet.
  double sine(glm::dvec3 seen_m, const Ray& ray) const;
};

/// Facet as seen from `apex_m`, which is the apex of `water` or a place near it. All places are in the local
/// frame. `rays`: rays from the apex of `water` to the true corners.
RefractedFacet refracted_facet(glm::dvec3 apex_m, const glm::dvec3 (&seen_m)[3],
                               const glm::dvec3 (&lies_m)[3], const Eigenray (&rays)[3],
                               const ApparentMap& water, double reference_absorption_db_per_m);

/// Surface that an image sees.
struct VisibleSurface {
  SharedFootprints shared;                  ///< visible polygons at apparent positions, as shared with
                                            ///< itself
  std::vector<RefractedFacet> refracted{};  ///< per facet of `shared`; empty: true and apparent positions
                                            ///< are equal

  const RefractedFacet* refracted_of(const SharedFacet& facet) const {
    return refracted.empty() ? nullptr : &refracted[static_cast<std::size_t>(&facet - shared.facets.data())];
  }
};

}  // namespace tubefoot
