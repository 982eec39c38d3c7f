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

/// Puts points, which are given by longitude, latitude [degrees] and local height, where they lie in the
/// local frame; heights stay. Throws InputError at `place`, in the words of `without_frame` for a frame that
/// does not lie on Earth.
void place_by_lon_lat(std::span<glm::dvec3> points, const LocalFrame& frame, const SourcePlace& place,
                      const char* without_frame);

/// Puts an object where its description says: scales along east, north and up, turns by roll,
/// pitch and heading, moves to its position, and sets it on the terrain, of which `height_m` tells the height
/// at a place east and north, if asked to; `extent` says where the terrain is. Throws InputError at the
/// object's place.
void place_object(ComponentMesh& mesh, const ObjectDescription& object, const LocalFrame& frame,
                  const std::function<std::optional<double>(double, double)>& height_m,
                  const std::function<std::string()>& extent);

}  // namespace tubefoot
