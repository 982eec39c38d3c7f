// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "run/simulation.hpp"

namespace tubefoot {

/// Returns the entries of stats.json about a run's scene, settings and counts.
nlohmann::ordered_json statistics_json(const Survey& survey, const RunRequest& request,
                                       const SimulationStats& stats);

/// Returns the peak memory of the program, in units of 2^20 bytes.
double peak_memory_mb();

}  // namespace tubefoot
