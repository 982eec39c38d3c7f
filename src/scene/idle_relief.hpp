// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace tubefoot {

/// A warning for each component on which relief moves points within the facets themselves: they stay flat,
/// and are refined all the same. `scene.report` names the components.
std::vector<std::string> idle_relief_warnings(const Scene& scene);

}  // namespace tubefoot
