// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>

#include "files/input_error.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

/// Position of the local east-north-up frame on Earth. Without it, coordinates are local metres.
struct GeoreferenceDescription {
  SourcePlace place;
  std::optional<std::array<double, 2>> origin_lat_lon_deg;  ///< latitude, longitude (WGS 84)
  std::optional<std::string> crs;  ///< e.g. "EPSG:32602"; defines the axes of the frame and the origin below
  std::optional<std::array<double, 2>> origin_crs;  ///< easting, northing in `crs`
  double origin_height_m = 0;                       ///< height of z = 0
};

}  // namespace tubefoot
