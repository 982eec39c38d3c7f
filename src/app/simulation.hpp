// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/survey.hpp"
#include "sensors/recording.hpp"

namespace tubefoot {

/// How well a reference run kept its tolerance.
struct ReferenceStats {
  std::size_t bins_over = 0;  ///< bins whose bound is above what was asked for
  double worst_ratio = 0;     ///< largest bound over what was asked for it
  std::string worst_sensor;
  std::size_t worst_ping = 0;
  int worst_beam = 0, worst_sample = 0;
};

/// What a simulation counted, summed over its pings. Seconds are those of each ping's task, added up.
struct SimulationStats {
  std::size_t pings = 0, tubes = 0, candidates = 0, footprints = 0, pieces = 0, hits = 0;
  double visibility_seconds = 0, echo_seconds = 0;
  ReferenceStats reference;
};

/// Runs all pings of all sensors with the engine that scene.description.run names. One recording per sensor.
/// With a tolerance, energies are enclosed (engine/reference.hpp) and recordings have bounds; that takes the
/// tube engine and an exact arithmetic. Throws std::runtime_error when InterruptGuard says that the user
/// wants to stop.
std::vector<Recording> simulate(const Survey& survey, bool quiet, SimulationStats& stats,
                                std::optional<double> reference_tolerance = {});

}  // namespace tubefoot
