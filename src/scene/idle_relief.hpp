// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace tubefoot {

/// Returns a warning for each component on which relief moves points within the planes of the facets. Such
/// facets stay flat but are refined. `scene.report` contains the names of the components.
std::vector<std::string> idle_relief_warnings(const Scene& scene);

}  // namespace tubefoot
