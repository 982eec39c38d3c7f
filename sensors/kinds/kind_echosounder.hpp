// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "scene/description/sensor_section.hpp"

namespace tubefoot {

/// One beam straight down. Without explicit patterns, transmitter and receiver have a Gaussian about the
/// axis.
struct EchosounderDescription {
  double frequency_khz = 200;
  double beam_deg = 7;               ///< full one-way width at -3 dB
  std::optional<double> sector_deg;  ///< side of the square sector; unset: three beam widths
  int samples = 1000;
  double range_min_m = 0.5, range_max_m = 50;
  std::string detection = "energy_centroid";  ///< first_return | energy_centroid | maximum
  double detection_threshold_db = -20;        ///< threshold of the detection relative to the largest sample

  static const SensorSection& kind();
};

}  // namespace tubefoot
