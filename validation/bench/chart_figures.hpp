// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// Measures the work of tubes and rays at equal error on the shipped scenes, as `tubefoot chart` does
/// (docs/accuracy-and-speed.md). The figures are ray_over_tube_at_0.1dB_<scene>,
/// ray_over_tube_at_1e-3_<scene> and crossing_l1_<scene>. A ratio is omitted if one side does not reach the
/// error. Throws as read_scene_file() and TrialScene do.
void chart_figures(const std::function<void(const std::string& name, double value)>& figure);

}  // namespace tubefoot
