// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "scene/description/object_description.hpp"
#include "scene/description/scene_component.hpp"
#include "scene/rasters/georeference.hpp"
#include "scene/trajectory.hpp"

namespace tubefoot {

/// Transforms points with longitude, latitude [degrees] and local height to the local frame; heights stay.
/// Throws InputError at `place` with the text `without_frame` if the frame has no position on Earth.
void place_by_lon_lat(std::span<glm::dvec3> points, const LocalFrame& frame, const SourcePlace& place,
                      const char* without_frame);

/// Places an object as its description states: scaling along east, north and up, rotation by roll, pitch
/// and heading, and translation. If requested, the object then stands on the terrain. Returns the pose of
/// the object's own axes at its origin. `height_m` returns
/// the height of the terrain at a position east and north, and `extent` describes where the terrain is.
/// Throws InputError at the object's place.
Pose place_object(ComponentMesh& mesh, const ObjectDescription& object, const LocalFrame& frame,
                  const std::function<std::optional<double>(double, double)>& height_m,
                  const std::function<std::string()>& extent);

/// Scales an object that moves on a trajectory, so that the mesh is in the object's own axes. Returns the
/// pose of these axes in the frame of the carrier.
Pose scaled_for_carrier(ComponentMesh& mesh, const ObjectDescription& object);

}  // namespace tubefoot
