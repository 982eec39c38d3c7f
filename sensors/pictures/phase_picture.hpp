// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "sensors/detection/receiver_pair_soundings.hpp"
#include "sensors/pictures/canvas.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// Draws the phases of an interferometric sidescan as a waterfall, last ping on top, port left. The hue is
/// the phase of the mean product under a pixel, and the brightness is its coherence. With `noise` it shows
/// the phases as received.
Canvas draw_phases(const Recording& recording, const std::string& font,
                   const InterferometricNoise* noise = nullptr);

}  // namespace tubefoot
