// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "scene/description/scene_description.hpp"

namespace tubefoot {

/// Returns warnings for angles that are probably radians because they are round in radians, such as 1.5708
/// or -0.785398. Keys expect degrees. The check covers objects, trajectories and the mounting of sensors.
std::vector<std::string> odd_angles(const SceneDescription& description);

}  // namespace tubefoot
