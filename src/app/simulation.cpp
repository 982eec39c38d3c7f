// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/simulation.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <mutex>
#include <span>
#include <stdexcept>
#include <tuple>

#include "app/interrupt.hpp"
#include "app/progress.hpp"
#include "engine/echo.hpp"
#include "engine/ray_engine.hpp"
#include "engine/reference.hpp"
#include "engine/tube_engine.hpp"

namespace tubefoot {
namespace {

using Clock = std::chrono::steady_clock;

/// An engine: tubes in, history out, in one or several portions that `take` each reads; their energies add
/// up. `beam_of_tube` is for engines that share work out by beams; `candidates` is added to by engines that
/// look at facets one by one.
using Take = std::function<void(const History& portion)>;
using Engine = std::function<void(TubeSet tubes, std::span<const std::uint32_t> beam_of_tube,
                                  std::uint64_t ping, std::size_t& candidates, const Take& take)>;

RaySettings ray_settings(const RunDescription& run) {
  const bool by_beam = run.rays_per_beam.has_value();
  return {ray_sampling_from_name(run.sampling), by_beam ? *run.rays_per_beam : run.rays_per_ping,
          by_beam ? RaySettings::Per::beam : RaySettings::Per::ping, run.seed};
}

VisibilityOptions options_of(const RunDescription& run) {
  VisibilityOptions options;
  options.arithmetic = arithmetic_from_name(run.arithmetic);
  options.facets_per_split = static_cast<std::uint32_t>(run.facets_per_split);
  options.tolerance = run.zero_tolerance;
  return options;
}

/// Of equals the one that comes first in the file, whichever thread was faster.
void keep_worst(ReferenceStats& kept, const ReferenceStats& met) {
  const auto place = [](const ReferenceStats& r) { return std::tie(r.worst_sensor, r.worst_ping); };
  if (met.worst_ratio < kept.worst_ratio ||
      (met.worst_ratio == kept.worst_ratio && !(place(met) < place(kept))))
    return;
  const std::size_t bins = kept.bins_over;
  kept = met;
  kept.bins_over = bins;
}

Engine make_engine(const Survey& survey) {
  const Scene& scene = survey.scene;
  const RunDescription& run = scene.description.run;
  const double unit = scene.grid.unit_m();
  if (run.engine == "ray") {
    const std::shared_ptr<const RayScene> rays =
        survey.rays ? survey.rays : std::make_shared<const RayScene>(scene.mesh, scene.grid);
    return
        [rays, unit, settings = ray_settings(run)](TubeSet tubes, std::span<const std::uint32_t> beam_of_tube,
                                                   std::uint64_t ping, std::size_t&, const Take& take) {
          RaySettings own = settings;
          // Every ping draws its own sample, so that errors of neighbours are independent.
          own.seed += 0x9e3779b97f4a7c15u * ping;
          History history;
          history.tubes = std::move(tubes);
          history.grid_unit_m = unit;
          trace_rays(*rays, history, own, beam_of_tube, [&] { take(history); });
        };
  }
  const auto engine = std::make_shared<TubeEngine>(scene.mesh, *survey.tree, unit, options_of(run));
  const bool measured = run.binning != "exact";
  return [engine, measured](TubeSet tubes, std::span<const std::uint32_t>, std::uint64_t,
                            std::size_t& candidates, const Take& take) {
    take(engine->trace(std::move(tubes), &candidates, measured));
  };
}

}  // namespace

std::vector<Recording> simulate(const Survey& survey, bool quiet, SimulationStats& stats,
                                std::optional<double> reference_tolerance) {
  const Scene& scene = survey.scene;
  std::vector<Recording> recordings;
  for (const SensorPings& pings : survey.sensors) {
    Recording recording;
    recording.sensor = pings.sensor.get();
    recording.ping_time_s = pings.times_s;
    recording.ping_pose = pings.poses;
    recording.energy.resize(pings.times_s.size() * pings.sensor->beams().size() *
                            static_cast<std::size_t>(pings.sensor->samples().count));
    if (reference_tolerance) recording.energy_bound.resize(recording.energy.size());
    recording.sound_speed_m_s = scene.sound_speed_m_s;
    recording.absorption_db_per_km = 1000 * absorption_db_per_m(scene, *pings.sensor);
    recordings.push_back(std::move(recording));
  }

  std::size_t total = 0;
  for (const SharedShots& group : survey.shots) total += survey.pings(group);
  const Engine engine = make_engine(survey);
  const Binning binning = binning_from_name(scene.description.run.binning);
  Progress progress("pings", total, quiet);
  std::mutex mutex;
  std::uint64_t label = 0;
  for (const SharedShots& group : survey.shots) {
    tbb::parallel_for(std::size_t{0}, survey.pings(group), [&](std::size_t ping) {
      if (InterruptGuard::requested()) return;
      SimulationStats own;
      const auto take = [&](const History& history) {
        const Clock::time_point start = Clock::now();
        for (const std::size_t s : group.sensors) {
          const Sensor& sensor = *survey.sensors[s].sensor;
          EchoLaw law{scene.material_mu, scene.mesh.material, absorption_db_per_m(scene, sensor)};
          BeamPatterns patterns;
          if (sensor.has_patterns()) {
            patterns = sensor.patterns(survey.sensors[s].poses[ping], scene.sound_speed_m_s);
            law.patterns = &patterns;
          }
          Echo echo = integrate_echo(history, sensor.beam_of_tube(), static_cast<int>(sensor.beams().size()),
                                     sensor.samples(), law, binning);
          const auto place = static_cast<std::ptrdiff_t>(ping * echo.energy.size());
          if (reference_tolerance) {
            CertifiedEcho certified =
                certify_echo(scene.mesh, *survey.tree, history, options_of(scene.description.run),
                             sensor.beam_of_tube(), sensor.samples(), law, echo, *reference_tolerance);
            std::copy(certified.bound.begin(), certified.bound.end(),
                      recordings[s].energy_bound.begin() + place);
            echo = std::move(certified.echo);
            const std::lock_guard lock(mutex);
            stats.reference.bins_over += certified.bins_over;
            keep_worst(stats.reference, {0, certified.worst_ratio, sensor.description().name, ping,
                                         certified.worst_beam, certified.worst_sample});
          }
          const auto energy = recordings[s].energy.begin() + place;
          std::transform(echo.energy.begin(), echo.energy.end(), energy, energy, std::plus<>());
        }
        own.tubes = history.tubes.tubes.size();
        own.footprints += history.footprints.footprints.size();
        own.pieces += history.footprints.pieces.size();
        own.hits += history.hits.size();
        own.echo_seconds += std::chrono::duration<double>(Clock::now() - start).count();
      };
      const Clock::time_point start = Clock::now();
      engine(survey.tubes(group, ping), survey.sensors[group.sensors.front()].sensor->beam_of_tube(),
             label + ping, own.candidates, take);
      own.visibility_seconds = std::chrono::duration<double>(Clock::now() - start).count() - own.echo_seconds;
      const std::lock_guard lock(mutex);
      stats.pings += group.sensors.size();
      stats.tubes += own.tubes;
      stats.candidates += own.candidates;
      stats.footprints += own.footprints;
      stats.pieces += own.pieces;
      stats.hits += own.hits;
      stats.visibility_seconds += own.visibility_seconds;
      stats.echo_seconds += own.echo_seconds;
      progress.step();
    });
    label += survey.pings(group);
  }
  if (InterruptGuard::requested()) throw std::runtime_error("interrupted: nothing was written");
  return recordings;
}

}  // namespace tubefoot
