// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// Measures the processor time of shadow = "fresnel" relative to sharp shadows, in the figure
/// fresnel_over_run. The scene is scenes/wellhead/scene.toml. The ratio is a median of interleaved runs.
void fresnel_figures(const std::function<void(const std::string& name, double value)>& figure);

}  // namespace tubefoot
