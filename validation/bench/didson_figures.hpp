// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// Measures frames per second of a DIDSON that moves about the well head of scenes/wellhead, on two
/// threads, from tubes to energies. The preset didson-identification has 8 cycles of 12 beams, each at its
/// own time and pose. The figures are didson_frames_per_s with the side lobes of uniform lines, and
/// didson_frames_per_s_ideal without patterns.
void didson_figures(const std::function<void(const std::string& name, double value)>& figure);

}  // namespace tubefoot
