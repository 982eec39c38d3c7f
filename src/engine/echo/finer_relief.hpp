// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "engine/surface/relief_error.hpp"
#include "engine/visibility/common_visibility.hpp"
#include "geometry/mesh/facet_mesh.hpp"

namespace tubefoot {

/// Energy-weighted means, over what a history saw, of how much finer relief would change a facet's energy,
/// relative and to first order. Estimates; neither is a proven bound.
struct FinerRelief {
  double largest = 0;  ///< with the largest omitted slope and height everywhere at once: from above
  double rms = 0;      ///< with their root mean squares: typical
  double weight = 0;   ///< of the means in a sum

  FinerRelief& operator+=(const FinerRelief& o);
};
FinerRelief finer_relief(const CommonVisibility& visibility, const FacetMesh& mesh,
                         const OmittedRelief& omitted, double sample_m);

}  // namespace tubefoot
