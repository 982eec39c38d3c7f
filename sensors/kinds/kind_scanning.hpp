// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "scene/description/sensor_section.hpp"

namespace tubefoot {

/// Mechanically scanning sonar: one beam that a motor turns by `step_deg` between transmissions. A ping is a
/// scan of `scan_deg`, and each of its steps is a separate beam.
struct ScanningDescription {
  double frequency_khz = 750;
  double scan_deg = 360, step_deg = 0.9;
  double beam_horizontal_deg = 2, beam_vertical_deg = 25;  ///< one-way widths of the ideal rectangular beam
  std::optional<double> step_interval_s;  ///< unset: two-way travel time to the last sample, and 20 ms for
                                          ///< the motor
  int samples = 1200;
  double range_min_m = 0.75, range_max_m = 50;

  static const SensorSection& kind();
};

}  // namespace tubefoot
