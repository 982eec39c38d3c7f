// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "scene/description/scene_component.hpp"

namespace tubefoot {

/// Heights of the highest terrain facet above or below places east and north (edges included), in their
/// order; nothing where there is none. Each facet is asked once, whatever the number of places.
std::vector<std::optional<double>> terrain_heights_m(std::span<const ComponentMesh> terrains,
                                                     std::span<const glm::dvec2> places_m);

}  // namespace tubefoot
