// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace tubefoot {

/// Centres of the beams of a DIDSON's lens [rad], port-most (negative) first. They follow the cubic k = f
/// (a3 t^3 + a2 t^2 + a1 t + a0) + 1 for the centre t [degrees, starboard positive] of beam k = 1 to N. The
/// coefficients are those of the MATLAB reader of DIDSON files and its descendants. Throws
/// std::invalid_argument unless there are 48 or 96 beams.
std::vector<double> lens_beam_centres(int beams);

/// Borders of adjacent beams, midway between their centres. The outermost two are symmetric about their
/// centres. Requires at least two centres in increasing order.
std::vector<double> borders_between(const std::vector<double>& centres);

}  // namespace tubefoot
