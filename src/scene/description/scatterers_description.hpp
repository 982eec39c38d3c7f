// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "files/input_error.hpp"

// What a scene file says: scene/description/scene_description.hpp.
namespace tubefoot {

/// The scatterers that signals come from (kind "array"): one field that belongs to the surface, whoever
/// looks.
struct ScatterersDescription {
  SourcePlace place;
  std::optional<double> spacing_m;  ///< none: as close as the scene's arrays can tell scatterers apart
  std::string texture = "none";     ///< none | gamma | log_normal
  double texture_shape = 1;         ///< 1 / variance of the texture
  double texture_cell_m = 0.1;
};

}  // namespace tubefoot
