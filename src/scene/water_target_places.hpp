// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "scene/description/scene_description.hpp"
#include "scene/extent.hpp"
#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// Returns the height from which depths count in the local frame: that of the sea surface.
double sea_surface_height_m(const SceneDescription& description);

/// Returns whether the scene states the height of the sea surface, so that the water ends there. Otherwise
/// the water has no surface, unless it refracts sound.
bool has_sea_surface(const SceneDescription& description);

/// Returns the position of a target in the water in the local frame. Throws InputError at its place if it has
/// a latitude and longitude, and the frame has no position on Earth.
glm::dvec3 position_of(const WaterTargetDescription& target, const LocalFrame& frame);

/// Returns the box of a population in the local frame.
Extent extent_of(const TargetPopulationDescription& population, double sea_surface_height_m);

/// Extent of a target or of a population.
struct TargetExtent {
  std::string name;
  SourcePlace place;
  Extent extent;
};
/// Returns the extents of all targets in the water. They lie on the grid of the scene, as vertices do.
std::vector<TargetExtent> water_target_extents(const SceneDescription& description, const LocalFrame& frame);

}  // namespace tubefoot
