// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/description/sensor_section.hpp"

namespace tubefoot {

/// Acoustic camera: a fan of beams side by side, one elevation cell.
struct DidsonDescription {
  double frequency_khz = 1800;
  int beams = 96;
  /// even: equal cells over `horizontal_deg` | lens: where the lens of a DIDSON has its 48 or 96 beams
  std::string beam_centres = "even";
  double horizontal_deg = 29, vertical_deg = 14;  ///< receive sector
  /// Transmit sector, about the same axis; without it, the receive sector. Tubes cover what both look at.
  std::optional<double> transmit_horizontal_deg, transmit_vertical_deg;
  /// With a receive pattern: how far the sector that is lit and received reaches beyond the outermost beams.
  double receive_margin_deg = 0;
  int cycles = 1;                          ///< transmissions of a frame: beam b belongs to cycle b mod cycles
  std::optional<double> cycle_interval_s;  ///< else as long as the echo of the window's end takes, and 420 us
  std::vector<int> firing_order;           ///< cycles as they follow one another; empty: 0, 1, 2, ...
  std::optional<std::string> transmit_steering;  ///< fan | beams; else beams if there are cycles
  int samples = 512;
  double window_start_m = 0.84, window_length_m = 5;
  std::string pictures = "all";  ///< all | sequence

  static const SensorSection& kind();
};

}  // namespace tubefoot
