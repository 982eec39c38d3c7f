// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "run/bounded_cache.hpp"
#include "run/region_plan.hpp"
#include "run/simulation.hpp"

namespace tubefoot {

/// Simulation of a survey whose terrain is read by tiles. Each ping is simulated in a survey with the tiles
/// that it needs (docs/notes/visibility.md).
class RegionalSimulation {
 public:
  RegionalSimulation(const Survey& survey, const RunRequest& request);

  /// Simulates a ping, as PingSimulation::run() does. Thread-safe. Throws InputError if a tile cannot be
  /// read.
  PingCounts run(const PingUnit& unit, PingValues& values);

 private:
  BoundedCache<PingSimulation>::Loaded load(std::size_t number) const;

  const Survey survey_;
  const RunRequest request_;
  const std::vector<ChosenEchoes> chosen_;
  const RegionPlan plan_;
  BoundedCache<PingSimulation> cache_;
};

}  // namespace tubefoot
