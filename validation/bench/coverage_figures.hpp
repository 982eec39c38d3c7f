// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// Measures the coverage of a wall (scenes/coverage/scene.toml), on one thread and in processes of its own.
///
/// The figure `coverage_100_pings_over_run` is the processor time of `tubefoot coverage` relative to that of
/// `tubefoot run`, and `coverage_peak_mb` is the peak memory of the former. The figure
/// `coverage_growth_exponent` is the exponent of the processor time of 25, 50 and 100 pings that are evenly
/// spaced along the trajectory. It is slightly above 1 if the time grows as n log n.
///
/// Call this function early, because the peak of a child includes the memory of its parent. Throws
/// std::runtime_error if a command fails.
void coverage_figures(const std::function<void(const std::string& name, double value)>& figure);

}  // namespace tubefoot
