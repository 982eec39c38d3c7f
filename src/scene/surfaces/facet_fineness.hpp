// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/description/object_description.hpp"

namespace tubefoot {

struct SceneDescription;

/// How finely a curved object is cut into facets.
struct FacetFineness {
  double chord_error_m = 0;  ///< largest distance between the surface and its facets
  std::string from;          ///< what it follows from, for people
};

/// What the object says, or a sixteenth of what the scene's sensors tell apart: the shortest of their range
/// samples and of their beams' widths at a quarter of their farthest range. Of the largest radius at least
/// 3/10000 (about 20 000 facets a sphere) and at most a fiftieth.
FacetFineness facet_fineness(const SceneDescription& scene, const ObjectDescription& object);

}  // namespace tubefoot
