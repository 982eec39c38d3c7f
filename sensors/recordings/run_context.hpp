// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "scene/description/water_description.hpp"
#include "scene/rasters/georeference.hpp"

namespace tubefoot {

/// What the files of a recording need to know of its run.
struct RunContext {
  LocalFrame frame;         ///< where the scene lies on Earth, if it says so
  double start_unix_s = 0;  ///< UTC of the recording's time 0
  std::uint64_t seed = 1;   ///< of speckle and noise
  WaterDescription water;
  std::string title;
};

}  // namespace tubefoot
