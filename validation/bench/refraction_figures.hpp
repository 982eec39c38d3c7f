// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// Measures the cost of refraction, refraction_over_straight: the seconds of the sidescan line of the survey
/// scene in two kinds of water. It is the ratio of the summer water of scenes/refraction, to 0.1 dB, and
/// isovelocity water. The seconds are medians of interleaved runs.
void refraction_figures(const std::function<void(const std::string& name, double value)>& figure);

}  // namespace tubefoot
