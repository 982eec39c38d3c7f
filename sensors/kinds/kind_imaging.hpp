// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "scene/description/sensor_section.hpp"

namespace tubefoot {

/// Imaging or forward-looking sonar: `beams` azimuth cells over `horizontal_deg`, one elevation cell.
struct ImagingDescription {
  double frequency_khz = 700;
  int beams = 256;
  double horizontal_deg = 130, vertical_deg = 20;
  std::string spacing = "angle";        ///< angle | distance: the quantity that is equal between neighbours
  std::vector<double> beam_angles_deg;  ///< from port to starboard, instead of `beams` over `horizontal_deg`
  int samples = 512;
  double range_min_m = 0.5, range_max_m = 20;

  static const SensorSection& kind();
};

}  // namespace tubefoot
