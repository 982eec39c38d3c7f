// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "files/input_error.hpp"

// What a scene file says: scene/description/scene_description.hpp.
namespace tubefoot {

/// A horizontal mirror over the scene.
struct SeaSurfaceDescription {
  SourcePlace place;
  double height_m = 0;
  double loss_db = 0;          ///< of every reflection
  double rms_roughness_m = 0;  ///< standard deviation of its heights: a further loss, Rayleigh's
};

/// Which paths are followed. docs/paths.md
struct PathsDescription {
  SourcePlace place;
  int order = 1;                  ///< most interactions (scattering and reflections) of a path
  std::optional<int> only_order;  ///< leave out all but this one
  double cutoff_db = 100;         ///< paths that lose more are not followed
  int scatterings = 1;            ///< most of them on a path
  double patch_m = 1;             ///< longest edge of patches, which all but the last scatter as
  int most_images = 10000;        ///< of one apex
  bool direct = false;            ///< a separate receiver also receives its transmitter straight
};

}  // namespace tubefoot
