// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// Measures the processor time of derivatives, relative to the run without them. The scene is a camera over a
/// terrain of 24 200 facets. The figure gradient_forward_over_run is for six pose parameters in forward mode.
/// The figure gradient_reverse_over_run is for reverse mode, with derivatives by all vertices. Both ratios
/// are medians of interleaved runs.
void gradient_figures(const std::function<void(const std::string& name, double value)>& figure);

}  // namespace tubefoot
