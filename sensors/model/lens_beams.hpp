// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace tubefoot {

/// Where the lens of a DIDSON has its beams: centres [rad], port-most (negative) first. They follow the cubic
/// k = f (a3 t^3 + a2 t^2 + a1 t + a0) + 1 for the centre t [degrees, starboard positive] of beam k = 1 to N,
/// as the MATLAB reader of DIDSON files and its descendants have it. Throws std::invalid_argument unless
/// there are 48 or 96.
std::vector<double> lens_beam_centres(int beams);

/// Borders of beams that meet midway between their centres; the outermost two reach as far outwards as
/// inwards. At least two centres, increasing.
std::vector<double> borders_between(const std::vector<double>& centres);

}  // namespace tubefoot
