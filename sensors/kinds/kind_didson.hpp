// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/description/sensor_section.hpp"

namespace tubefoot {

/// Acoustic camera: a fan of adjacent beams, one elevation cell.
struct DidsonDescription {
  double frequency_khz = 1800;
  int beams = 96;
  /// even: equal cells over `horizontal_deg`; lens: the 48 or 96 beams of the lens of a DIDSON
  std::string beam_centres = "even";
  double horizontal_deg = 29, vertical_deg = 14;  ///< receive sector
  /// Transmit sector about the same axis; unset: the receive sector. Tubes cover the intersection of both.
  std::optional<double> transmit_horizontal_deg, transmit_vertical_deg;
  /// With a receive pattern: extent of the insonified and received sector beyond the outermost beams.
  double receive_margin_deg = 0;
  int cycles = 1;                          ///< transmissions per frame: beam b belongs to cycle b mod cycles
  std::optional<double> cycle_interval_s;  ///< unset: two-way travel time to the end of the range gate, and
                                           ///< 420 us
  std::vector<int> firing_order;           ///< order of the cycles; empty: 0, 1, 2, ...
  std::optional<std::string> transmit_steering;  ///< fan | beams; unset: beams if cycles > 1
  int samples = 512;
  double window_start_m = 0.84, window_length_m = 5;
  std::string pictures = "all";  ///< all | sequence

  static const SensorSection& kind();
};

}  // namespace tubefoot
