// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/canvas.hpp"
#include "sensors/recording.hpp"

namespace tubefoot {

/// Draws one ping of an acoustic camera in fan geometry: slant range from the camera at the bottom, azimuth
/// to the sides, forward up and port left, both axes at one scale. A pixel shows the mean energy of the cells
/// (beam, sample) at a square of points in it, nearest cell, no interpolation. Beams must be equal azimuth
/// cells. `font` as for Canvas.
Canvas draw_camera_frame(const Recording& recording, std::size_t ping, const std::string& font);

}  // namespace tubefoot
