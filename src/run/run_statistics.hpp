// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "run/simulation.hpp"

namespace tubefoot {

/// What stats.json says of a run's scene, settings and counts.
nlohmann::ordered_json statistics_json(const Survey& survey, const SimulationStats& stats,
                                       const std::optional<double>& reference_tolerance);

/// Most memory that the program had at a time, in units of 2^20 bytes.
double peak_memory_mb();

}  // namespace tubefoot
