// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "files/input_error.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

/// The scatterers that produce signals (kind "array"). Their field is fixed to the surface and independent
/// of the sensor.
struct ScatterersDescription {
  SourcePlace place;
  std::optional<double> spacing_m;  ///< by default as close as the resolution of the scene's arrays requires
  std::string texture = "none";     ///< none | gamma | log_normal
  double texture_shape = 1;         ///< 1 / variance of the texture
  double texture_cell_m = 0.1;
};

}  // namespace tubefoot
