// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/description/object_description.hpp"

namespace tubefoot {

struct SceneDescription;

/// Fineness of the facets of a curved object.
struct FacetFineness {
  double chord_error_m = 0;  ///< largest distance between the surface and its facets
  std::string from;          ///< reason for this value, for the user
};

/// Returns the chord error of the object's description, or a sixteenth of the best resolution of the
/// scene's sensors. The resolution is the minimum of the range samples and of the beam widths at a quarter
/// of the largest range. The error is at least 3/10000 of the largest radius (about 20 000 facets per
/// sphere) and at most a fiftieth.
FacetFineness facet_fineness(const SceneDescription& scene, const ObjectDescription& object);

}  // namespace tubefoot
