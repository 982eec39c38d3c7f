// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sensors/pictures/canvas.hpp"
#include "sensors/recordings/echo_reader.hpp"

namespace tubefoot {

/// Energies of two sensors with the same pings, beams and samples.
struct ComparedEchoes {
  const SensorEchoes* reference = nullptr;
  const SensorEchoes* candidate = nullptr;
  double lit_threshold_j = 0;  ///< a bin shows a difference if one of its two energies exceeds this
  std::size_t ping = 0;        ///< ping to draw, for sensors that are drawn ping by ping
};

/// Returns whether all pings are drawn at once, as a waterfall. This holds for sensors of one or two beams
/// (sidescan). Other sensors are drawn one ping at a time, with beams across and slant range upwards.
bool drawn_as_waterfall(const SensorEchoes& sensor);

/// Draws reference, candidate and their ratio in dB side by side, one row per sensor. Both energies share
/// one scale, whose 0 dB is the 99.9th percentile of the reference. The range of the ratio fits the
/// differences. A pixel shows the mean energy of the bins that it covers. A waterfall has a time-varied
/// gain of 40 log R. `subtitle` names the two sides. `font` as for Canvas.
Canvas draw_comparison(const std::vector<ComparedEchoes>& sensors, const std::vector<std::string>& subtitle,
                       const std::string& font);

/// Colour of a ratio: at -1 and below the candidate is weaker, at 0 equal, at 1 stronger.
Colour difference_colour(double level);

}  // namespace tubefoot
