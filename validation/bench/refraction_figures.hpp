// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// What refraction costs: refraction_over_straight, seconds of the survey scene's sidescan line through the
/// summer water of scenes/refraction, to 0.1 dB, over those through isovelocity water. Medians of interleaved
/// runs.
void refraction_figures(const std::function<void(const std::string& name, double value)>& figure);

}  // namespace tubefoot
