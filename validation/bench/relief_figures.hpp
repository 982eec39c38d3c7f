// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// Measures the cost of relief that is made during a run (scenes/sand), as `tubefoot run` does.
///
/// The figures `relief_frames_per_s` and `relief_peak_mb` are those of a camera over a patch that would have
/// hundreds of millions of facets. The figure `relief_saving` is the number of cells of the whole seabed
/// divided by the number of facets of a frame over ripples.
///
/// Each run has its own process; call this function first. Throws std::runtime_error if a run fails.
void relief_figures(const std::function<void(const std::string& name, double value)>& figure);

}  // namespace tubefoot
