// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/surfaces/material_map_gdal.hpp"

#include <fmt/core.h>

namespace tubefoot {

void carry_map_points(std::span<glm::dvec3> points, const std::string& crs, const LocalFrame& frame,
                      const SourcePlace& place, const char* remedy) {
  if (frame.is_georeferenced() == crs.empty())
    throw InputError(place, fmt::format("has {} coordinate reference system, but the scene's frame is{} "
                                        "georeferenced: {}",
                                        crs.empty() ? "no" : "a", crs.empty() ? "" : " not", remedy));
  if (!crs.empty()) frame.carry(points, crs, place);
}

}  // namespace tubefoot
