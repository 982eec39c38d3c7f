// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/pictures/canvas.hpp"

namespace tubefoot {

/// One turn of phase is one turn of the circle of hues; brightness is 0 to 1.
Colour phase_colour(double phase_rad, double brightness);

/// Draws a bar of the hues with their degrees in the pixels [x, x + DecibelScale::legend_width) x [y0, y1).
void draw_phase_legend(Canvas& canvas, int x, int y0, int y1);

}  // namespace tubefoot
