// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// Measures the processor time of motion within a ping, relative to stop and hop. The scene is a multibeam
/// over a terrain of 80 000 facets. The figure motion_interval_over_run is the time of one more interval of
/// the record. The figure motion_linear is the time of 16 intervals relative to four times that of 4. Both
/// ratios are medians of interleaved runs.
void motion_figures(const std::function<void(const std::string& name, double value)>& figure);

}  // namespace tubefoot
