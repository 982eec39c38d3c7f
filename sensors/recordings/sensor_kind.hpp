// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "scene/description/scene_description.hpp"

namespace tubefoot {

/// The kind of a sensor as scene files name it.
std::string kind_of(const SensorDescription& sensor);

}  // namespace tubefoot
