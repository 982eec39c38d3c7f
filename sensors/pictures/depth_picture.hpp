// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "sensors/detection/cell_means.hpp"
#include "sensors/pictures/canvas.hpp"

namespace tubefoot {

/// Draws mean depths of soundings by cell (SoundingGrid): shaded relief lit from the north-west, coloured by
/// depth, with axes, scale and legend. Throws std::runtime_error without cells.
Canvas draw_depths(const CellMeans& depths, const std::string& title, const std::string& font);

}  // namespace tubefoot
