// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sensors/pictures/canvas.hpp"
#include "sensors/recordings/echo_reader.hpp"

namespace tubefoot {

/// Two sensors' energies that lie on the same pings, beams and samples.
struct ComparedEchoes {
  const SensorEchoes* reference = nullptr;
  const SensorEchoes* candidate = nullptr;
  double lit_threshold_j = 0;  ///< bins above it on either side show a difference
  std::size_t ping = 0;        ///< the ping to draw, of sensors that are drawn ping by ping
};

/// Whether all pings are drawn at once, as a waterfall: sensors of one or two beams (a sidescan). Others are
/// drawn one ping at a time, beams across and slant range up.
bool drawn_as_waterfall(const SensorEchoes& sensor);

/// Reference, candidate and their ratio in dB side by side, a row for each sensor. The two energies share one
/// scale, whose 0 dB is the reference's 99.9th percentile; the ratio's range fits the differences. A pixel
/// shows the mean energy of the bins it covers; in a waterfall after a time-varied gain of 40 log R.
/// `subtitle` names the two sides. `font` as for Canvas.
Canvas draw_comparison(const std::vector<ComparedEchoes>& sensors, const std::vector<std::string>& subtitle,
                       const std::string& font);

/// What the ratio's colours stand for: -1 (and below) the candidate is weaker, 0 equal, 1 stronger.
Colour difference_colour(double level);

}  // namespace tubefoot
