// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/pictures/canvas.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// Draws a sidescan recording as a waterfall: slant range to port left and to starboard right, the first ping
/// at the bottom and the last on top, so that forward is up. Pings are repeated so that along-track and
/// across-track scales are equal, within limits (and the subtitle says where they are not). A pixel shows the
/// mean energy of the cells (ping, sample) that it covers, weighted by their shares of it. Beam 0 is port.
/// `font` as for Canvas. With `heard`, what the instrument shows: on the scale of the ideal picture, or,
/// where the receiver has a gain of its own, after that gain alone and on its own scale.
Canvas draw_waterfall(const Recording& recording, const std::string& font, const Heard* heard = nullptr);

}  // namespace tubefoot
