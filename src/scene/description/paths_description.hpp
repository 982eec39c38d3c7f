// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "files/input_error.hpp"

// Part of the description of a scene file: scene/description/scene_description.hpp.
namespace tubefoot {

/// Selection of propagation paths. docs/environment.md
struct PathsDescription {
  SourcePlace place;
  int order = 1;                  ///< largest number of interactions (scattering and reflections) per path
  std::optional<int> only_order;  ///< selects paths of this order only
  double cutoff_db = 100;         ///< paths with a larger loss are dropped
  int scatterings = 1;            ///< largest number of scatterings per path
  double patch_m = 1;  ///< longest edge of radiosity patches, which represent all scatterings except the last
  int most_images = 10000;  ///< per apex
  bool direct = false;      ///< a separate receiver also receives the direct sound of its transmitter
};

}  // namespace tubefoot
