// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tubefoot {

/// What a sidescan line costs, as `tubefoot run` makes it, each run in a process of its own: survey_peak_mb
/// and survey_pings_per_s of 500 pings over a whole real grid (scenes/real-grid/sidescan-line.toml), and
/// survey_growth_mb, how much more memory 2000 pings over a flat seabed take than 100. Call it first: a
/// child's peak begins with what its parent holds. Throws std::runtime_error where a run fails.
void survey_figures(const std::function<void(const std::string& name, double value)>& figure);

/// stats.json of `tubefoot run` on a scene, in a process of its own. Throws std::runtime_error.
nlohmann::json stats_of_run(const std::filesystem::path& scene);

}  // namespace tubefoot
