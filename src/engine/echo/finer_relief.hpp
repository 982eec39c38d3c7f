// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/surface/relief_error.hpp"
#include "engine/visibility/common_visibility.hpp"
#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

/// Energy-weighted means, over the surface that a history saw, of the relative first-order change of a
/// facet's energy by finer relief. Both are estimates, not proven bounds.
struct FinerRelief {
  double largest = 0;  ///< for the largest omitted slope and height everywhere: an upper estimate
  double rms = 0;      ///< for their root mean squares: a typical value
  double weight = 0;   ///< weight of the means in a sum

  FinerRelief& operator+=(const FinerRelief& o);
};
FinerRelief finer_relief(const CommonVisibility& visibility, const FacetMesh& mesh,
                         const OmittedRelief& omitted, double sample_m);

}  // namespace tubefoot
