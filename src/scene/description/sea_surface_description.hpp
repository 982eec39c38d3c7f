// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/input_error.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

/// A horizontal mirror above the scene.
struct SeaSurfaceDescription {
  SourcePlace place;
  double height_m = 0;
  double loss_db = 0;          ///< loss per reflection
  double rms_roughness_m = 0;  ///< standard deviation of the height; causes a further (Rayleigh) loss
};

}  // namespace tubefoot
