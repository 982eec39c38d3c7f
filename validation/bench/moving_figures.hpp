// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// Measures the processor time of a moving object relative to the same object at rest. The scene is a camera
/// that moves over a terrain of 119 000 facets, with 30 pings. The figure moving_objects_over_run is for
/// tubes, and moving_objects_over_rays for rays. Both ratios are medians of interleaved runs.
void moving_figures(const std::function<void(const std::string& name, double value)>& figure);

}  // namespace tubefoot
