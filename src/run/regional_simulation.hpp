// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "run/bounded_cache.hpp"
#include "run/region_plan.hpp"
#include "run/simulation.hpp"

namespace tubefoot {

/// The pings of a survey whose terrain is read by tiles, each simulated in a survey that has those it needs
/// (docs/big-terrain.md).
class RegionalSimulation {
 public:
  /// The survey outlives it.
  RegionalSimulation(const Survey& survey, std::optional<double> reference_tolerance);

  /// As PingSimulation::run(), from several threads. Throws InputError where a tile cannot be read.
  PingCounts run(std::size_t group, std::size_t ping, PingStore& store, std::size_t slot);

 private:
  struct Region {
    std::unique_ptr<const Survey> survey;
    std::unique_ptr<const PingSimulation> simulation;
  };
  BoundedCache<Region>::Loaded load(std::size_t number) const;

  const Survey& survey_;
  std::optional<double> reference_tolerance_;
  const RegionPlan plan_;
  BoundedCache<Region> cache_;
};

}  // namespace tubefoot
