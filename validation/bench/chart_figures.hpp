// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace tubefoot {

/// What tubes and rays cost at equal error, as `tubefoot chart` measures it (docs/chart.md), on the shipped
/// scenes: ray_over_tube_at_0.1dB_<scene>, ray_over_tube_at_1e-3_<scene>, crossing_l1_<scene>. A ratio that
/// cannot be told because one side does not come that far is left out. Throws as read_scene_file() and
/// TrialScene do.
void chart_figures(const std::function<void(const std::string& name, double value)>& figure);

}  // namespace tubefoot
