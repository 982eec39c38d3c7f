// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>

#include "sensors/pictures/canvas.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// Draws a single beam's pings side by side, ranges downwards, in dB. `energy_j`: [ping][sample].
/// `bottom_m`: by ping, drawn as a line; NaN without a detection. `said`: description of the energies for
/// the subtitle.
Canvas draw_echogram(const Recording& recording, std::span<const float> energy_j,
                     std::span<const double> bottom_m, const std::string& font, const std::string& said = {});

}  // namespace tubefoot
