// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <string>

#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// Transforms points of a CRS (empty for local metres) into the frame. If only one of them is
/// georeferenced, it throws InputError with the text `remedy`.
void carry_map_points(std::span<glm::dvec3> points, const std::string& crs, const LocalFrame& frame,
                      const SourcePlace& place, const char* remedy);

}  // namespace tubefoot
