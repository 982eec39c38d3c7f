// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tubefoot {

/// Measures the cost of a sidescan line, as `tubefoot run` makes it, each run in a process of its own.
///
/// The figures `survey_peak_mb` and `survey_pings_per_s` are those of 500 pings over a whole real grid
/// (scenes/real-grid/sidescan-line.toml). The figure `survey_growth_mb` is the additional memory of 2000
/// pings over a flat seabed relative to 100 pings.
///
/// Call this function first, because the peak of a child includes the memory of its parent. Throws
/// std::runtime_error if a run fails.
void survey_figures(const std::function<void(const std::string& name, double value)>& figure);

/// Runs `tubefoot run` on a scene in a separate process and returns its stats.json. Throws
/// std::runtime_error.
nlohmann::json stats_of_run(const std::filesystem::path& scene);

}  // namespace tubefoot
