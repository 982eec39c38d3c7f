// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/description/sensor_section.hpp"

namespace tubefoot {

/// Imaging or forward-looking sonar: `beams` equal azimuth cells over `horizontal_deg`, one elevation cell.
struct ImagingDescription {
  double frequency_khz = 700;
  int beams = 256;
  double horizontal_deg = 130, vertical_deg = 20;
  int samples = 512;
  double range_min_m = 0.5, range_max_m = 20;

  static const SensorSection& kind();
};

}  // namespace tubefoot
