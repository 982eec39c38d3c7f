// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>

#include "files/input_error.hpp"

// What a scene file says: scene/description/scene_description.hpp.
namespace tubefoot {

/// Where the local east-north-up frame lies. Without it, coordinates are local metres already.
struct GeoreferenceDescription {
  SourcePlace place;
  std::optional<std::array<double, 2>> origin_lat_lon_deg;  ///< latitude, longitude (WGS 84)
  std::optional<std::string> crs;                   ///< e.g. "EPSG:32602": frame axes and origin below
  std::optional<std::array<double, 2>> origin_crs;  ///< easting, northing in `crs`
  double origin_height_m = 0;                       ///< height that becomes z = 0
};

}  // namespace tubefoot
