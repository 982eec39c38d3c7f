// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "app/survey.hpp"
#include "sensors/recording.hpp"

namespace tubefoot {

/// What a simulation counted, summed over its pings. Seconds are those of each ping's task, added up.
struct SimulationStats {
  std::size_t pings = 0, tubes = 0, candidates = 0, footprints = 0, pieces = 0, hits = 0;
  double visibility_seconds = 0, echo_seconds = 0;
};

/// Runs all pings of all sensors with the engine that scene.description.run names. One recording per sensor.
/// Throws std::runtime_error when InterruptGuard says that the user wants to stop.
std::vector<Recording> simulate(const Survey& survey, bool quiet, SimulationStats& stats);

}  // namespace tubefoot
