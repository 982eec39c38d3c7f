// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "scene/description/scene_description.hpp"

namespace tubefoot {

/// Warnings of angles that are round ones in radians, as 1.5708 and -0.785398 are: they count degrees. Of
/// objects, trajectories and the mounting of sensors.
std::vector<std::string> odd_angles(const SceneDescription& description);

}  // namespace tubefoot
