// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/regional_simulation.hpp"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace tubefoot {
namespace {

/// Limit of a region. Deep trees and long waits cost more than tiles that neighbouring regions load twice.
constexpr std::size_t most_region_facets = 1 << 20, bytes_a_region_facet = 64;

std::size_t cache_bytes(const Survey& survey) {
  return static_cast<std::size_t>(survey.scene.description.run.terrain_cache_mb) * 1'000'000;
}

}  // namespace

RegionalSimulation::RegionalSimulation(const Survey& survey, const RunRequest& request)
    : survey_(survey),
      request_(request),
      chosen_(chosen_of(survey, request.selection)),
      plan_(Transmissions(survey, request),
            std::min(most_region_facets, cache_bytes(survey) / (4 * bytes_a_region_facet))),
      cache_(cache_bytes(survey), [this](std::size_t region) { return load(region); }) {
  survey.loaded_scene->terrain_use->regions = plan_.regions().size();
}

PingCounts RegionalSimulation::run(const PingUnit& unit, PingValues& values) {
  const std::size_t whole = unit.ping + first_ping(survey_.transmissions[unit.group], chosen_);
  const std::size_t number = plan_.of(unit.group, whole);
  const std::shared_ptr<const PingSimulation> region = cache_.get(number);
  // The thread with a region's first ping loads the next region while other threads compute.
  if (plan_.regions()[number].first_ping == whole && number + 1 < plan_.regions().size() &&
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism) > 1) {
    try {
      cache_.get(number + 1);
    } catch (const InputError&) {
      // The pings of that region will report the error.
    }
  }
  survey_.loaded_scene->terrain_use->loads = cache_.loads();
  survey_.loaded_scene->terrain_use->most_bytes = cache_.most_bytes_held();
  return region->run(unit, values);
}

BoundedCache<PingSimulation>::Loaded RegionalSimulation::load(std::size_t number) const {
  // A thread that waits for a part of this work must not start a ping, because that ping could wait for this
  // region.
  return tbb::this_task_arena::isolate([&] {
    const Survey survey = survey_with_tiles(survey_, plan_.regions()[number].tiles);
    auto simulation = std::make_shared<const PingSimulation>(survey, request_);
    const FacetMesh& mesh = survey.scene.mesh;
    std::size_t bytes = mesh.vertices.size() * sizeof(GridPoint) + mesh.facets.size() * 16 +
                        survey.loaded_scene->tree->bytes();
    if (survey.loaded_scene->surface_mesh)
      bytes += survey.loaded_scene->tree->bytes() + mesh.vertices.size() * 32;
    return BoundedCache<PingSimulation>::Loaded{std::move(simulation), bytes};
  });
}

}  // namespace tubefoot
