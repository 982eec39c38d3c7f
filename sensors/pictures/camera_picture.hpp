// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/pictures/canvas.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// Draws one ping of an acoustic camera in fan geometry: slant range from the camera at the bottom, azimuth
/// to the sides, forward up and port left, both axes at one scale. A pixel shows the mean energy of the cells
/// (beam, sample) at a square of points in it, nearest cell, no interpolation. Beams meet midway between
/// their axes. `font` as for Canvas. With `heard`,
/// what the instrument shows, on the scale of the ideal picture unless the receiver has a gain of its own.
Canvas draw_camera_frame(const Recording& recording, std::size_t ping, const std::string& font,
                         const Heard* heard = nullptr);

/// Which pings of a recording its sequence shows: at most 20, evenly spread, the first and the last among
/// them.
std::vector<std::size_t> sequence_frames(std::size_t pings);
/// Draws them as small fans, five a row, all on one scale of decibels.
Canvas draw_camera_sequence(const Recording& recording, const std::string& font,
                            const Heard* heard = nullptr);

}  // namespace tubefoot
