// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "sensors/detection/cell_means.hpp"
#include "sensors/pictures/canvas.hpp"

namespace tubefoot {

/// Draws a map of amplitudes: north up, equal scales, in dB, with axes in metres of the local frame. A pixel
/// shows the mean power of the cells with values under it. `font` as for Canvas.
Canvas draw_mosaic(const CellMeans& amplitudes, double display_gain_db, const std::string& title,
                   const std::string& font);

}  // namespace tubefoot
