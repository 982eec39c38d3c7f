// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// Measures the processor time of a run with volume scattering relative to the same run without it. The scene
/// is a camera over a rough terrain of 119 000 facets, with 10 pings. All ratios are medians of interleaved
/// runs. The figures are:
/// - volume_over_run: uniform water
/// - volume_layers_over_run: four layers
/// - volume_patterns_over_run: uniform water, beams with line patterns
void water_figures(const std::function<void(const std::string& name, double value)>& figure);

}  // namespace tubefoot
