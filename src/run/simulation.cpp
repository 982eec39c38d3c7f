// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/simulation.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>

#include "geometry/steps/stop.hpp"
#include "run/abilities.hpp"
#include "run/refraction.hpp"
#include "run/regional_simulation.hpp"

namespace tubefoot {

StoreLayout layout_of(const Survey& survey, const RunRequest& request) {
  StoreLayout layout;
  layout.with_bounds = request.reference_tolerance.has_value();
  for (const SensorPings& pings : survey.sensors)
    layout.sensors.push_back(
        {pings.times_s.size(), static_cast<std::size_t>(pings.sensor->channels()) *
                                   pings.sensor->beams().size() *
                                   static_cast<std::size_t>(pings.sensor->samples().count)});
  for (const SharedShots& group : survey.shots)
    layout.groups.push_back({group.sensors, survey.fleet->pings(group)});
  return layout;
}

PingSimulation::PingSimulation(const Survey& survey, const RunRequest& request) : shots_(survey, request) {
  require_able_to_run(survey, request);
  if (survey.site->is_tiled()) {
    by_regions_ = std::make_unique<RegionalSimulation>(survey, request);
    return;
  }
  for (const SharedShots& group : survey.shots) parts_.push_back(echo_parts(shots_, group));
  if (request.engine == Engine::ray && !survey.site->has_ground_a_shot()) survey.site->rays();
}

PingSimulation::~PingSimulation() = default;

PingCounts PingSimulation::run(std::size_t group, std::size_t ping, PingStore& store,
                               std::size_t slot) const {
  if (by_regions_) return by_regions_->run(group, ping, store, slot);
  const auto start = std::chrono::steady_clock::now();
  const SharedShots& sensors = shots_.survey().shots[group];
  PingSums sums(sensors, store, slot);
  for (std::size_t number = 0; number < shots_.survey().fleet->shots_a_ping(sensors); ++number) {
    const Shot shot = shots_.of(sensors, ping, number);
    for (const EchoPart& part : parts_[group]) part.add(shot, sums);
  }
  PingCounts counts = sums.counts;
  counts.finer_relief_largest = sums.finer_relief.largest;
  counts.finer_relief_rms = sums.finer_relief.rms;
  counts.visibility_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() - counts.echo_seconds;
  return counts;
}

void simulate(const Survey& survey, const RunRequest& request, PingStore& store, const Onlookers& onlookers) {
  const PingSimulation simulation(survey, request);
  const std::size_t left = layout_of(survey, request).units() - store.done_units();
  if (onlookers.watch != nullptr) onlookers.watch->total = left;
  Progress progress("pings", left, onlookers.quiet);
  const auto take = [&](std::size_t g, std::size_t ping) {
    if (store.done(g, ping) || stop_wanted()) return;
    const auto run = [&] { store.finish(g, ping, simulation.run(g, ping, store, ping)); };
    // A thread that waits for others must not begin a second ping: each holds the ground of its shot.
    try {
      if (survey.site->ground || survey.site->is_tiled())
        tbb::this_task_arena::isolate(run);
      else
        run();
    } catch (const Interrupted&) {
      return;
    }
    progress.step();
    if (onlookers.watch != nullptr) ++onlookers.watch->pings;
  };
  for (std::size_t g = 0; g < survey.shots.size(); ++g) {
    const std::size_t pings = survey.fleet->pings(survey.shots[g]);
    if (!survey.site->is_tiled()) {
      tbb::parallel_for(std::size_t{0}, pings, [&](std::size_t ping) { take(g, ping); });
      continue;
    }
    // One after the other, so that all threads are in few regions at a time.
    std::atomic<std::size_t> next{0};
    tbb::parallel_for(
        0, tbb::this_task_arena::max_concurrency(),
        [&](int) {
          for (std::size_t ping = next++; ping < pings && !tbb::is_current_task_group_canceling();
               ping = next++)
            take(g, ping);
        },
        tbb::simple_partitioner());
  }
}

SimulationStats totals(const Survey& survey, const PingStore& store) {
  SimulationStats stats;
  PingCounts worst;
  for (std::size_t g = 0; g < survey.shots.size(); ++g)
    for (std::size_t ping = 0; ping < survey.fleet->pings(survey.shots[g]); ++ping) {
      const PingCounts& counts = store.counts(g, ping);
      stats.pings += survey.shots[g].sensors.size();
      stats.tubes += counts.tubes;
      stats.candidates += counts.candidates;
      stats.footprints += counts.footprints;
      stats.pieces += counts.pieces;
      stats.hits += counts.hits;
      stats.refined_facets += counts.refined_facets;
      stats.finer_relief_largest = std::max(stats.finer_relief_largest, counts.finer_relief_largest);
      stats.finer_relief_rms = std::max(stats.finer_relief_rms, counts.finer_relief_rms);
      add_counts(stats.refraction, counts.refraction);
      stats.shadowed_pings += counts.refraction.in_shadow > 0 ? survey.shots[g].sensors.size() : 0;
      stats.images += counts.images;
      stats.arrivals += counts.arrivals;
      std::transform(counts.energy_of_order.begin(), counts.energy_of_order.end(),
                     stats.energy_of_order.begin(), stats.energy_of_order.begin(), std::plus<>());
      stats.visibility_seconds += counts.visibility_seconds;
      stats.echo_seconds += counts.echo_seconds;
      if (counts.worst_ratio > worst.worst_ratio) stats.reference.worst_ping = ping;
      keep_worst(worst, counts);
    }
  stats.reference.bins_over = worst.bins_over;
  stats.reference.worst_ratio = worst.worst_ratio;
  stats.reference.worst_beam = static_cast<int>(worst.worst_beam);
  stats.reference.worst_sample = static_cast<int>(worst.worst_sample);
  if (worst.worst_ratio > 0)
    stats.reference.worst_sensor = survey.sensors[worst.worst_sensor].sensor->description().name;
  return stats;
}

std::vector<Recording> recordings_of(const Survey& survey, const std::shared_ptr<PingStore>& store) {
  std::vector<Recording> recordings;
  for (std::size_t s = 0; s < survey.sensors.size(); ++s) {
    const SensorPings& pings = survey.sensors[s];
    Recording recording;
    recording.sensor = pings.sensor.get();
    recording.ping_time_s = pings.times_s;
    recording.ping_pose = pings.poses;
    recording.line_starts = pings.line_starts;
    recording.altitude_m = pings.altitudes_m;
    recording.energy = store->energy(s);
    recording.energy_bound = store->bound(s);
    recording.release = [store, s](std::size_t ping) { store->release(s, ping); };
    recording.sound_speed_m_s = pings.sound_speed_m_s;
    recording.absorption_db_per_km = 1000 * absorption_db_per_m(survey.scene, *pings.sensor);
    recordings.push_back(std::move(recording));
  }
  return recordings;
}

std::vector<Recording> simulate(const Survey& survey, const RunRequest& request, SimulationStats& stats,
                                const Onlookers& onlookers) {
  const auto store = std::make_shared<PingStore>(layout_of(survey, request));
  simulate(survey, request, *store, onlookers);
  stop_if_wanted();
  stats = totals(survey, *store);
  return recordings_of(survey, store);
}

}  // namespace tubefoot
