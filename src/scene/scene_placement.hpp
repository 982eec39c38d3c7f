// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "scene/description/object_description.hpp"
#include "scene/description/scene_component.hpp"
#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// Height of the highest terrain facet above or below a place (edges included); nothing where there is none.
std::optional<double> terrain_height_m(std::span<const ComponentMesh> terrains, double east_m,
                                       double north_m);

/// Puts an object where its description says: scales along east, north and up, turns by roll,
/// pitch and heading, moves to its position, and sets it on the terrain, of which `height_m` tells the height
/// at a place east and north, if asked to; `extent` says where the terrain is. Throws InputError at the
/// object's place.
void place_object(ComponentMesh& mesh, const ObjectDescription& object, const LocalFrame& frame,
                  const std::function<std::optional<double>(double, double)>& height_m,
                  const std::function<std::string()>& extent);

}  // namespace tubefoot
