// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/simulation.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <numeric>
#include <span>
#include <stdexcept>

#include "engine/certified/reference.hpp"
#include "engine/echo/bistatic_echo.hpp"
#include "engine/echo/echo.hpp"
#include "engine/echo/staff_echo.hpp"
#include "engine/paths/path_echo.hpp"
#include "engine/rays/ray_engine.hpp"
#include "engine/sight/tube_engine.hpp"
#include "files/usage_error.hpp"
#include "geometry/work/stop.hpp"
#include "run/abilities.hpp"
#include "run/console/progress.hpp"
#include "run/own_engine.hpp"
#include "run/paths.hpp"
#include "run/refracted_reference.hpp"
#include "run/refraction.hpp"
#include "run/regional_simulation.hpp"
#include "run/sensor_law.hpp"
#include "run/settings.hpp"
#include "run/shot_ground.hpp"

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

/// `ground` outlives the engine.
Engine make_engine(const Survey& survey, const ShotGround& ground) {
  const Scene& scene = survey.scene;
  const RunDescription& run = scene.description.run;
  const double unit = scene.grid.unit_m();
  if (run.engine == "ray") {
    const std::shared_ptr<const RayScene> rays =
        survey.rays && !ground.is_own() ? survey.rays
                                        : std::make_shared<const RayScene>(ground.mesh(), scene.grid);
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
  const auto engine = std::make_shared<TubeEngine>(ground.mesh(), ground.tree(), unit, options_of(run));
  const bool measured = run.binning != "exact";
  return [engine, measured](TubeSet tubes, std::span<const std::uint32_t>, std::uint64_t,
                            std::size_t& candidates, const Take& take) {
    take(engine->trace(std::move(tubes), &candidates, measured));
  };
}

/// Keeps the worse; of equals the one met first.
void keep_worst(PingCounts& kept, const PingCounts& met) {
  kept.bins_over += met.bins_over;
  if (met.worst_ratio <= kept.worst_ratio) return;
  kept.worst_ratio = met.worst_ratio;
  kept.worst_sensor = met.worst_sensor;
  kept.worst_beam = met.worst_beam;
  kept.worst_sample = met.worst_sample;
}

/// Simulates one ping of the sensors that share its shots.
class PingTask {
 public:
  /// `slot`: the ping of `store` that it becomes.
  PingTask(const Survey& survey, const SharedShots& group, std::size_t ping, PingStore& store,
           std::size_t slot, Binning binning, std::optional<double> reference_tolerance)
      : survey_(survey),
        group_(group),
        ping_(ping),
        store_(store),
        slot_(slot),
        binning_(binning),
        reference_tolerance_(reference_tolerance),
        only_order_(survey.scene.description.paths.only_order),
        staffs_apart_(survey.scene.description.run.engine == "tube" && binning == Binning::exact) {}

  /// `engine` of the scene's own facets; unused where shots have their own ground.
  PingCounts run(const Engine& engine, std::uint64_t label) {
    for (const std::size_t s : group_.sensors)
      for (const std::span<double> values : {store_.energy(s, slot_), store_.bound(s, slot_)})
        std::fill(values.begin(), values.end(), 0.0);  // of a ping that was cut off
    const Clock::time_point start = Clock::now();
    for (std::size_t shot = 0; shot < survey_.shots_a_ping(group_); ++shot) {
      if (survey_.own_engine) {
        for (const std::size_t s : group_.sensors) take_own(shot, s);
        continue;
      }
      for (const std::size_t s : group_.sensors) take_paths(shot, s);
      if (only_order_.value_or(1) != 1) continue;
      if (reference_tolerance_ && survey_.scene.water->refracts()) {
        take_refracted_reference(shot);
        continue;
      }
      if (survey_.scene.water->refracts() &&
          survey_.sensors[group_.sensors.front()].sensor->has_receiver_apart()) {
        take_refracted_paths(shot);
        continue;
      }
      const ShotGround ground = ground_of(survey_, group_, ping_, shot);
      if (ground.apparent() != nullptr)
        add_counts(counts_.refraction, *ground.apparent(), survey_, group_, ping_, shot);
      if (survey_.ground) counts_.refined_facets += ground.mesh().facets.size();
      if (survey_.sensors[group_.sensors.front()].sensor->has_receiver_apart()) {
        take_bistatic(ground, shot);
        continue;
      }
      take_staffs(ground, shot);
      if (staffs_apart_ && std::all_of(group_.sensors.begin(), group_.sensors.end(),
                                       [&](std::size_t s) { return survey_.sensors[s].sensor->has_staff(); }))
        continue;
      std::size_t candidates = 0;
      const Engine own = ground.is_own() ? make_engine(survey_, ground) : Engine();
      (own ? own : engine)(survey_.tubes(group_, ping_, shot),
                           survey_.sensors[group_.sensors.front()].sensor->beam_of_tube(shot),
                           label + (std::uint64_t(shot) << 40), candidates,
                           [&](const History& history) { take(ground, history, shot); });
      counts_.candidates += candidates;
    }
    counts_.finer_relief_largest = finer_relief_.largest;
    counts_.finer_relief_rms = finer_relief_.rms;
    counts_.visibility_seconds =
        std::chrono::duration<double>(Clock::now() - start).count() - counts_.echo_seconds;
    return counts_;
  }

 private:
  void take(const ShotGround& ground, const History& history, std::size_t shot) {
    const Clock::time_point start = Clock::now();
    for (const std::size_t s : group_.sensors)
      if (!(staffs_apart_ && survey_.sensors[s].sensor->has_staff())) add_echo(ground, history, shot, s);
    if (survey_.relief.omitted)
      finer_relief_ +=
          finer_relief(history, ground.mesh(), *survey_.relief.omitted, sample_length_m(survey_, group_));
    counts_.tubes += history.tubes.tubes.size();
    counts_.footprints += history.footprints.footprints.size();
    counts_.pieces += history.footprints.pieces.size();
    counts_.hits += history.hits.size();
    counts_.echo_seconds += std::chrono::duration<double>(Clock::now() - start).count();
  }

  void take_own(std::size_t shot, std::size_t s) {
    const Sensor& sensor = *survey_.sensors[s].sensor;
    const std::vector<std::uint32_t>& beams = sensor.beams_of_shot(shot);
    std::vector<double> energy(beams.size() * static_cast<std::size_t>(sensor.samples().count));
    survey_.own_engine->echo(survey_, {s, ping_, shot}, energy);
    add_order(1, energy, beams, s);
  }

  /// Paths over mirrors. Every sensor follows its own: its range says how far.
  void take_paths(std::size_t shot, std::size_t s) {
    const Scene& scene = survey_.scene;
    const Sensor& sensor = *survey_.sensors[s].sensor;
    const std::optional<PathSettings> settings = path_settings(scene, sensor.frequency_khz());
    if (!settings) return;
    TubeSet transmit = survey_.tubes(group_, ping_, shot), receive = survey_.receive_tubes(s, ping_, shot);
    transmit.reach = receive.reach = 2 * sensor.reach(scene.grid);
    const SensorLaw law(survey_, ShotGround(survey_), s, ping_, shot);
    const std::vector<std::uint32_t> fans = sensor.fan_of_tube(shot);
    const std::vector<std::uint32_t>& beams = sensor.beams_of_shot(shot);
    PathEcho paths;
    try {
      paths = path_echo(scene.mesh, *survey_.tree, scene.grid.unit_m(), options_of(scene.description.run),
                        transmit, receive,
                        {static_cast<int>(beams.size()), sensor.beam_of_tube(shot), fans, fans},
                        sensor.samples(), law.law, *settings);
    } catch (const std::length_error& error) {
      throw InputError(sensor.description().place,
                       fmt::format("sensor '{}', paths: {}", sensor.description().name, error.what()));
    }
    for (std::size_t order = 0; order < paths.by_order.size(); ++order)
      if (only_order_.value_or(int(order)) == int(order))
        add_order(order, paths.by_order[order].energy, beams, s);
    counts_.images += paths.images;
    counts_.arrivals += paths.arrivals;
    counts_.pieces += paths.shared_pieces;
  }

  void add_order(std::size_t order, std::span<const double> energy, const std::vector<std::uint32_t>& beams,
                 std::size_t s) {
    const std::size_t cells =
        beams.size() * static_cast<std::size_t>(survey_.sensors[s].sensor->samples().count);
    counts_.energy_of_order[order] +=
        std::accumulate(energy.begin(), energy.begin() + std::ptrdiff_t(cells), 0.0);
    add_rows(energy, beams, energy.size() / cells, store_.energy(s, slot_));
  }

  /// A receiver that is apart shares its shots with nobody.
  void take_bistatic(const ShotGround& ground, std::size_t shot) {
    const Scene& scene = survey_.scene;
    const std::size_t s = group_.sensors.front();
    const BistaticHistory history =
        trace_bistatic(ground.mesh(), ground.tree(), scene.grid.unit_m(), options_of(scene.description.run),
                       survey_.tubes(group_, ping_, shot), survey_.receive_tubes(s, ping_, shot));
    take_shared(history, ground.mesh(), shot);
  }

  void take_refracted_paths(std::size_t shot) {
    const RefractedPaths paths =
        refracted_paths_of(survey_, group_, ping_, shot, options_of(survey_.scene.description.run));
    for (const ApparentGround* ground : {&paths.pair.transmit, &paths.pair.receive})
      add_counts(counts_.refraction, *ground, survey_, group_, ping_, shot);
    for (const PairedFacet& facet : paths.history.paired)
      counts_.refraction.largest_gap_m = std::max(counts_.refraction.largest_gap_m, facet.misfit_m);
    if (survey_.ground) counts_.refined_facets += paths.pair.mesh.facets.size();
    take_shared(paths.history, paths.pair.mesh, shot);
  }

  /// `mesh`: that of the history's facets.
  void take_shared(const BistaticHistory& history, const FacetMesh& mesh, std::size_t shot) {
    const std::size_t s = group_.sensors.front();
    const Sensor& sensor = *survey_.sensors[s].sensor;
    const Clock::time_point start = Clock::now();
    if (survey_.relief.omitted)
      finer_relief_ += finer_relief(history, mesh, *survey_.relief.omitted, sensor.samples().step_m);
    SensorLaw law(survey_, ShotGround(survey_), s, ping_, shot);
    law.law.material = mesh.material;
    const std::vector<std::uint32_t> fans = sensor.fan_of_tube(shot);
    const std::vector<std::uint32_t>& beams = sensor.beams_of_shot(shot);
    const Echo echo = integrate_bistatic_echo(
        history, {static_cast<int>(beams.size()), sensor.beam_of_tube(shot), fans, fans}, sensor.samples(),
        law.law);
    add_order(1, echo.energy, beams, s);
    counts_.tubes += history.transmit.tubes.size() + history.receive.tubes.size();
    counts_.footprints += history.shared.facets.size();
    counts_.pieces += history.shared.pieces.size();
    counts_.echo_seconds += std::chrono::duration<double>(Clock::now() - start).count();
  }

  /// Footprints of sensors with two receivers a fan: each receiver's own.
  void take_staffs(const ShotGround& ground, std::size_t shot) {
    if (!staffs_apart_) return;
    const Scene& scene = survey_.scene;
    for (const std::size_t s : group_.sensors) {
      const Sensor& sensor = *survey_.sensors[s].sensor;
      if (!sensor.has_staff()) continue;
      const SensorLaw law(survey_, ground, s, ping_, shot);
      const TubeSet tubes = survey_.tubes(group_, ping_, shot);
      const std::vector<std::uint32_t> fans = sensor.fan_of_tube(shot), &beams = sensor.beams_of_shot(shot);
      const auto samples = static_cast<std::size_t>(sensor.samples().count);
      std::vector<double> all(4 * beams.size() * samples);
      for (std::uint32_t fan = 0; fan < law.patterns.fringes.size(); ++fan) {
        const Fringe& staff = law.patterns.fringes[fan];
        const StaffHistory history =
            trace_staff(ground.mesh(), ground.tree(), scene.grid.unit_m(), options_of(scene.description.run),
                        tubes_of_fan(tubes, fans, fan), staff);
        const Clock::time_point start = Clock::now();
        const StaffEcho echo = integrate_staff_echo(history, staff, fan, fan, sensor.samples(), law.law);
        std::size_t channel = 0;
        for (const auto* row : {&echo.upper_j, &echo.lower_j, &echo.cross_real_j, &echo.cross_imag_j})
          std::copy(row->begin(), row->end(),
                    all.begin() + std::ptrdiff_t((channel++ * beams.size() + fan) * samples));
        if (survey_.relief.omitted)
          finer_relief_ +=
              finer_relief({history.transmit, history.upper, scene.grid.unit_m(), history.by_upper},
                           ground.mesh(), *survey_.relief.omitted, sensor.samples().step_m);
        counts_.tubes += 3 * history.transmit.tubes.size();
        counts_.footprints += history.by_upper.facets.size() + history.by_lower.facets.size();
        counts_.pieces += history.pieces();
        counts_.echo_seconds += std::chrono::duration<double>(Clock::now() - start).count();
      }
      add_order(1, all, beams, s);
    }
  }

  void add_echo(const ShotGround& ground, const History& history, std::size_t shot, std::size_t s) {
    const Scene& scene = survey_.scene;
    const Sensor& sensor = *survey_.sensors[s].sensor;
    const std::vector<std::uint32_t>& beams = sensor.beams_of_shot(shot);
    const SensorLaw sensor_law(survey_, ground, s, ping_, shot);
    const EchoLaw& law = sensor_law.law;
    Echo echo = integrate_echo(history, sensor.beam_of_tube(shot), static_cast<int>(beams.size()),
                               sensor.samples(), law, binning_);
    if (reference_tolerance_) {
      const CertifiedEcho certified =
          certify_echo(ground.mesh(), ground.tree(), history, options_of(scene.description.run),
                       sensor.beam_of_tube(shot), sensor.samples(), law, echo, *reference_tolerance_);
      add_bounds(certified, beams, s);
      echo = certified.echo;
    }
    add_order(1, echo.energy, beams, s);
  }

  void add_bounds(const CertifiedEcho& certified, const std::vector<std::uint32_t>& beams, std::size_t s) {
    add_rows(certified.bound, beams, 1, store_.bound(s, slot_));
    PingCounts met;
    met.bins_over = certified.bins_over;
    met.worst_ratio = certified.worst_ratio;
    met.worst_sensor = static_cast<std::uint32_t>(s);
    met.worst_beam = beams[static_cast<std::size_t>(certified.worst_beam)];
    met.worst_sample = static_cast<std::uint32_t>(certified.worst_sample);
    keep_worst(counts_, met);
  }

  /// Through refracting water a reference chooses its own apparent ground.
  void take_refracted_reference(std::size_t shot) {
    const RefractedShot found = certify_refracted_shot(
        survey_, group_, ping_, shot, options_of(survey_.scene.description.run), *reference_tolerance_);
    counts_.refraction.at_limit += found.at_limit;
    add_counts(counts_.refraction, *found.ground.apparent(), survey_, group_, ping_, shot);
    counts_.candidates += found.candidates;
    counts_.tubes += found.history.tubes.tubes.size();
    counts_.footprints += found.history.footprints.footprints.size();
    counts_.pieces += found.history.footprints.pieces.size();
    for (std::size_t k = 0; k < group_.sensors.size(); ++k) {
      const std::size_t s = group_.sensors[k];
      const std::vector<std::uint32_t>& beams = survey_.sensors[s].sensor->beams_of_shot(shot);
      const RefractedReference& reference = found.sensors[k];
      counts_.refraction.unbounded += reference.unbounded;
      add_bounds(reference.certified, beams, s);
      add_order(1, reference.certified.echo.energy, beams, s);
    }
  }

  /// `rows`: [channel][beam of the shot][sample]; `all`: of the sensor's beams.
  static void add_rows(std::span<const double> rows, const std::vector<std::uint32_t>& beams,
                       std::size_t channels, std::span<double> all) {
    const std::size_t samples = rows.size() / (beams.size() * channels),
                      all_beams = all.size() / (channels * samples);
    for (std::size_t row = 0; row < beams.size() * channels; ++row) {
      const std::size_t place = row / beams.size() * all_beams + beams[row % beams.size()];
      const std::span<double> to = all.subspan(place * samples, samples);
      const std::span<const double> from = rows.subspan(row * samples, samples);
      std::transform(from.begin(), from.end(), to.begin(), to.begin(), std::plus<>());
    }
  }

  const Survey& survey_;
  const SharedShots& group_;
  std::size_t ping_;
  PingStore& store_;
  std::size_t slot_;
  Binning binning_;
  std::optional<double> reference_tolerance_;
  FinerRelief finer_relief_;
  std::optional<int> only_order_;
  bool staffs_apart_;  ///< each receiver of a staff sees for itself; else by the transmitter's history
  PingCounts counts_;
};

}  // namespace

StoreLayout layout_of(const Survey& survey, bool with_bounds) {
  StoreLayout layout;
  layout.with_bounds = with_bounds;
  for (const SensorPings& pings : survey.sensors)
    layout.sensors.push_back(
        {pings.times_s.size(), static_cast<std::size_t>(pings.sensor->channels()) *
                                   pings.sensor->beams().size() *
                                   static_cast<std::size_t>(pings.sensor->samples().count)});
  for (const SharedShots& group : survey.shots) layout.groups.push_back({group.sensors, survey.pings(group)});
  return layout;
}

struct PingSimulation::Parts {
  ShotGround whole;
  Engine engine;  ///< of the scene's own facets; empty where shots have their own ground
  Binning binning;
  std::vector<std::uint64_t> first_label;          ///< by group
  std::unique_ptr<RegionalSimulation> by_regions;  ///< where terrain is read by tiles; else null
};

PingSimulation::PingSimulation(const Survey& survey, std::optional<double> reference_tolerance)
    : survey_(survey), reference_tolerance_(reference_tolerance) {
  require_able_to_run(survey, reference_tolerance.has_value());
  parts_ = std::make_unique<Parts>(
      Parts{ShotGround(survey), {}, binning_from_name(survey.scene.description.run.binning), {}, {}});
  if (survey.is_tiled()) {
    parts_->by_regions = std::make_unique<RegionalSimulation>(survey, reference_tolerance);
    return;
  }
  const bool own_grounds = survey.ground || survey.scene.water->refracts();
  if (!own_grounds) parts_->engine = make_engine(survey, parts_->whole);
  std::uint64_t label = 0;
  for (const SharedShots& group : survey.shots) {
    parts_->first_label.push_back(label);
    label += survey.pings(group);
  }
}

PingSimulation::~PingSimulation() = default;

PingCounts PingSimulation::run(std::size_t group, std::size_t ping, PingStore& store,
                               std::size_t slot) const {
  if (parts_->by_regions) return parts_->by_regions->run(group, ping, store, slot);
  PingTask task(survey_, survey_.shots[group], ping, store, slot, parts_->binning, reference_tolerance_);
  return task.run(parts_->engine, parts_->first_label[group] + ping);
}

void simulate(const Survey& survey, PingStore& store, bool quiet, std::optional<double> reference_tolerance) {
  const PingSimulation simulation(survey, reference_tolerance);
  const std::size_t left = layout_of(survey, false).units() - store.done_units();
  if (survey.watch) survey.watch->total = left;
  Progress progress("pings", left, quiet);
  const auto take = [&](std::size_t g, std::size_t ping) {
    if (store.done(g, ping) || stop_wanted()) return;
    const auto run = [&] { store.finish(g, ping, simulation.run(g, ping, store, ping)); };
    // A thread that waits for others must not begin a second ping: each holds the ground of its shot.
    try {
      if (survey.ground || survey.is_tiled())
        tbb::this_task_arena::isolate(run);
      else
        run();
    } catch (const Interrupted&) {
      return;
    }
    progress.step();
    if (survey.watch) ++survey.watch->pings;
  };
  for (std::size_t g = 0; g < survey.shots.size(); ++g) {
    const std::size_t pings = survey.pings(survey.shots[g]);
    if (!survey.is_tiled()) {
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
    for (std::size_t ping = 0; ping < survey.pings(survey.shots[g]); ++ping) {
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

std::vector<Recording> simulate(const Survey& survey, bool quiet, SimulationStats& stats,
                                std::optional<double> reference_tolerance) {
  const auto store = std::make_shared<PingStore>(layout_of(survey, reference_tolerance.has_value()));
  simulate(survey, *store, quiet, reference_tolerance);
  stop_if_wanted();
  stats = totals(survey, *store);
  return recordings_of(survey, store);
}

}  // namespace tubefoot
