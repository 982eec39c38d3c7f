// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "scene/description/scene_component.hpp"

namespace tubefoot {

/// Returns the heights of the highest terrain facet at positions east and north (edges included), in their
/// order; empty where there is no terrain. Each facet is visited once, for any number of positions.
std::vector<std::optional<double>> terrain_heights_m(std::span<const ComponentMesh> terrains,
                                                     std::span<const glm::dvec2> places_m);

}  // namespace tubefoot
