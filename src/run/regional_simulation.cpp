// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/regional_simulation.hpp"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace tubefoot {
namespace {

/// Deep trees and long waits cost more than what neighbouring regions load twice.
constexpr std::size_t most_facets = 1 << 20, bytes_a_region_facet = 64;

std::size_t cache_bytes(const Survey& survey) {
  return static_cast<std::size_t>(survey.scene.description.run.terrain_cache_mb) * 1'000'000;
}

}  // namespace

RegionalSimulation::RegionalSimulation(const Survey& survey, std::optional<double> reference_tolerance)
    : survey_(survey),
      reference_tolerance_(reference_tolerance),
      plan_(survey, std::min(most_facets, cache_bytes(survey) / (4 * bytes_a_region_facet))),
      cache_(cache_bytes(survey), [this](std::size_t region) { return load(region); }) {
  survey.terrain_use->regions = plan_.regions().size();
}

PingCounts RegionalSimulation::run(std::size_t group, std::size_t ping, PingStore& store, std::size_t slot) {
  const std::size_t number = plan_.of(group, ping);
  const std::shared_ptr<const Region> region = cache_.get(number);
  // Who has a region's first ping loads the next one while others work.
  if (plan_.regions()[number].first_ping == ping && number + 1 < plan_.regions().size() &&
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism) > 1) {
    try {
      cache_.get(number + 1);
    } catch (const InputError&) {
      // Its own pings will tell.
    }
  }
  survey_.terrain_use->loads = cache_.loads();
  survey_.terrain_use->most_bytes = cache_.most_bytes_held();
  return region->simulation->run(group, ping, store, slot);
}

BoundedCache<RegionalSimulation::Region>::Loaded RegionalSimulation::load(std::size_t number) const {
  // Who waits for a part of this must not begin a ping meanwhile, which could wait for this in turn.
  return tbb::this_task_arena::isolate([&] {
    Region region;
    region.survey = survey_with_tiles(survey_, plan_.regions()[number].tiles);
    region.simulation = std::make_unique<const PingSimulation>(*region.survey, reference_tolerance_);
    const FacetMesh& mesh = region.survey->scene.mesh;
    std::size_t bytes =
        mesh.vertices.size() * sizeof(GridPoint) + mesh.facets.size() * 16 + region.survey->tree->bytes();
    if (region.survey->ground) bytes += region.survey->tree->bytes() + mesh.vertices.size() * 32;
    return BoundedCache<Region>::Loaded{std::make_shared<const Region>(std::move(region)), bytes};
  });
}

}  // namespace tubefoot
