// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pugixml.hpp>
#include <string>

#include "exchange/readers/world_parts.hpp"

// Readers of the parts of an SDF link.
namespace tubefoot {

/// Reads the <geometry> of a <visual> or <collision>. `placed`: its axes in the world. `name`: of the object.
void read_sdf_shape(WorldParts& parts, pugi::xml_node visual, const Placement& placed, std::string name);

/// Reads a <sensor>: the multibeam sonars of DAVE and of uuv_simulator, and lidars with vertical rays.
/// `link`, `placed`: the axes of the link and of the sensor in the world.
void read_sdf_sensor(WorldParts& parts, pugi::xml_node sensor, const Placement& link,
                     const Placement& placed);

}  // namespace tubefoot
