// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "scene/description/sensor_section.hpp"

namespace tubefoot {

/// One beam straight down. Where no patterns are given it sends and receives with a Gaussian about its axis.
struct EchosounderDescription {
  double frequency_khz = 200;
  double beam_deg = 7;               ///< full one-way width at -3 dB
  std::optional<double> sector_deg;  ///< side of the square that is looked at; none: three beam widths
  int samples = 1000;
  double range_min_m = 0.5, range_max_m = 50;
  std::string detection = "energy_centroid";  ///< first_return | energy_centroid | maximum
  double detection_threshold_db = -20;        ///< of samples that count, over the largest

  static const SensorSection& kind();
};

}  // namespace tubefoot
