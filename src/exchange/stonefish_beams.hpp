// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace tubefoot {

/// Returns the number of views of Stonefish's forward-looking sonar (FLS) for a fan of this width: one per 20
/// degrees.
int stonefish_views(double width_deg);

/// Returns the beam axes of an FLS with `beams` beams, port first, starboard positive. The beams of each view
/// are equidistant columns of a picture. All views are as wide as the one with most beams (OpenGLFLS.cpp of
/// Stonefish 1.6). Returns nothing if the engine cannot divide the beams into views. Then a view would have
/// less than 0 beams or a width of 180 degrees, or beams of adjacent views would overlap.
std::vector<double> stonefish_beam_angles_deg(int beams, double width_deg);

}  // namespace tubefoot
