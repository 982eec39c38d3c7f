// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// What relief online costs, as `tubefoot run` makes it (scenes/sand): relief_frames_per_s and relief_peak_mb
/// of a camera over a patch that would have hundreds of millions of facets, and relief_saving, how many times
/// fewer facets a frame over ripples makes than the whole seabed has in cells. Runs in processes of their
/// own; call it first. Throws std::runtime_error where a run fails.
void relief_figures(const std::function<void(const std::string& name, double value)>& figure);

}  // namespace tubefoot
