// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/simulation.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "geometry/steps/stop.hpp"
#include "run/abilities.hpp"
#include "run/gradients.hpp"
#include "run/labels.hpp"
#include "run/refraction.hpp"
#include "run/regional_simulation.hpp"
#include "run/signal_gradients.hpp"
#include "run/signals.hpp"
#include "run/stored_pings.hpp"
#include "run/surfaces.hpp"

// This file simulates the pings of a survey on all threads, sums their counts, and makes recordings from the
// store.

namespace tubefoot {
namespace {

/// Returns the output channels of a sensor. Checkpoints, shards and ranks enumerate them. `beams`: number of
/// stored beams. `labels`: number of label channels (LabelChannels), or 0.
std::vector<OutputChannel> output_channels(const Survey& survey, std::size_t s, std::size_t beams,
                                           const RunRequest& request, std::size_t labels) {
  const Sensor& sensor = *survey.sensors[s].sensor;
  const auto samples = static_cast<std::size_t>(sensor.samples().count);
  const std::size_t cells = beams * samples;
  const auto rows = static_cast<std::size_t>(sensor.channels());
  std::vector<OutputChannel> channels;
  const auto add = [&](const std::string& name, std::size_t values, std::size_t chunks,
                       const auto& variables) {
    channels.push_back({name, values, chunks, variables(false)});
    if (request.reference_tolerance) channels.push_back({name + "_bound", values, chunks, variables(true)});
  };
  add("energy", rows * cells, rows, [&](bool bounds) { return energy_variables(rows, bounds); });
  if (const SignalModel* model = sensor.signals())
    add("signals", 2 * model->array.receivers_m.size() * model->sampling.samples, 1,
        [](bool) { return std::vector<ChannelVariable>(); });
  if (labels > 0) channels.push_back({"labels", labels * cells});
  std::ranges::move(gradient_channels(survey.scene, request, beams, samples), std::back_inserter(channels));
  std::ranges::move(signal_gradient_channels(survey, s, request), std::back_inserter(channels));
  return channels;
}

/// Returns the contributions by group. Throws as require_able_to_run() does.
std::vector<std::vector<EchoContribution>> plan_of(const Survey& survey, const RunRequest& request) {
  require_able_to_run(survey, request);
  require_gradients(survey, request);
  std::vector<std::vector<EchoContribution>> plan;
  if (survey.loaded_scene->is_tiled()) return plan;
  for (const SharedTransmissions& group : survey.transmissions)
    plan.push_back(contributions_to(survey, request, group));
  return plan;
}

/// Returns the request for the energies alone, without bounds, labels and derivatives.
RunRequest ordinary_request(RunRequest request) {
  request.reference_tolerance.reset();
  request.labels = false;
  request.gradient.clear();
  request.gradient_steps = false;
  return request;
}

/// Moves each value to the nearest value to the ordinary one in its enclosure, because midpoints are biased
/// where enclosures are one-sided. Each bound becomes the larger distance to the ends of the enclosure.
/// `values` and `bounds` contain midpoints and half-widths.
void clip(std::span<const double> ordinary, std::span<double> values, std::span<double> bounds) {
  constexpr double rounding = 1e-15;  // of the sum below
  for (std::size_t bin = 0; bin < values.size(); ++bin) {
    const double middle = values[bin], half = bounds[bin];
    values[bin] = std::clamp(ordinary[bin], middle - half, middle + half);
    bounds[bin] = (std::abs(middle - values[bin]) + half) * (1 + rounding);
  }
}

}  // namespace

StoreLayout layout_of(const Survey& survey, const RunRequest& request) {
  StoreLayout layout;
  const std::vector<ChosenEchoes> chosen = chosen_of(survey, request.selection);
  const std::size_t labels = request.labels ? LabelChannels(survey, request).channels() : 0;
  for (std::size_t s = 0; s < chosen.size(); ++s)
    layout.sensors.push_back(
        {chosen[s].pings, output_channels(survey, s, chosen[s].beams.size(), request, labels)});
  for (const SharedTransmissions& group : survey.transmissions) {
    StoreLayout::Group& kept = layout.groups.emplace_back();
    for (const std::size_t s : group.sensors) {
      if (chosen[s].pings == 0) continue;
      kept.sensors.push_back(s);
      kept.pings = chosen[s].pings;  // all sensors of a group have the same number of pings
    }
  }
  return layout;
}

PingSimulation::PingSimulation(const Survey& survey, const RunRequest& request)
    : plan_(plan_of(survey, request)),
      transmissions_(survey, with_needs(request, plan_)),
      layout_(layout_of(survey, request)),
      chosen_(chosen_of(survey, request.selection)) {
  if (survey.loaded_scene->is_tiled())
    by_regions_ = std::make_unique<RegionalSimulation>(survey, request);
  else if (request.engine == Engine::ray && !survey.loaded_scene->has_surface_per_transmission())
    survey.loaded_scene->rays();
  if (!request.reference_tolerance || request.keeps_midpoints || by_regions_) return;
  ordinary_ = std::make_unique<PingSimulation>(survey, ordinary_request(request));
  // Signals take long and have bounds of their own.
  for (std::vector<EchoContribution>& of_group : ordinary_->plan_)
    std::erase_if(of_group, [](const EchoContribution& part) { return part.add == add_signals; });
  for (StoreLayout::Sensor& sensor : ordinary_->layout_.sensors)
    std::erase_if(sensor.channels, [](const OutputChannel& channel) { return channel.name == "signals"; });
}

PingSimulation::~PingSimulation() = default;

void PingSimulation::clip_to_enclosures(const PingUnit& unit, PingValues& values, PingCounts& counts) const {
  ordinary_buffers_.with([&](PingValues& ordinary) {
    const PingCounts more = ordinary_->run(unit, ordinary);
    counts.visibility_seconds += more.visibility_seconds;
    counts.echo_seconds += more.echo_seconds;
    counts.energy_of_order = more.energy_of_order;
    for (const std::size_t s : layout_.groups[unit.group].sensors)
      clip(std::as_const(ordinary).of(s, "energy"), values.of(s, "energy"), values.of(s, "energy_bound"));
  });
}

PingCounts PingSimulation::run(const PingUnit& unit, PingValues& values) const {
  if (by_regions_) return by_regions_->run(unit, values);
  const auto start = std::chrono::steady_clock::now();
  const SharedTransmissions& sensors = transmissions_.survey().transmissions[unit.group];
  values.clear(layout_, unit.group);
  PingSums sums(chosen_, values);
  const std::size_t ping = unit.ping + first_ping(sensors, chosen_);
  for (std::size_t number = 0; number < transmissions_.survey().sensor_set->transmissions_per_ping(sensors);
       ++number) {
    const Transmission transmission = transmissions_.of(sensors, ping, number);
    for (const EchoContribution& contribution : plan_[unit.group])
      contribution.add(contribution, transmission, sums);
  }
  PingCounts counts = sums.counts;
  counts.finer_relief_largest = sums.finer_relief.largest;
  counts.finer_relief_rms = sums.finer_relief.rms;
  counts.visibility_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() - counts.echo_seconds;
  if (ordinary_) clip_to_enclosures(unit, values, counts);
  return counts;
}

PingOrder ping_order_of(const StoreLayout& layout) {
  std::vector<std::size_t> pings;
  for (const auto& group : layout.groups) pings.push_back(group.pings);
  return PingOrder(pings);
}

void for_each_ping(const Survey& survey, const StoreLayout& layout, const IsPending& is_pending,
                   const PingCallback& process, const ProgressOptions& progress_options) {
  std::size_t all = 0;
  for (std::size_t g = 0; g < layout.groups.size(); ++g)
    for (std::size_t ping = 0; ping < layout.groups[g].pings; ++ping) all += is_pending(g, ping);
  if (progress_options.watch != nullptr) progress_options.watch->total = all;
  const bool has_signals = std::ranges::any_of(
      survey.sensors, [](const SensorPings& p) { return p.sensor->signals() != nullptr; });
  Progress progress("pings", all, progress_options.quiet, progress_options.afterwards_s);
  const auto take = [&](std::size_t g, std::size_t ping) {
    if (!is_pending(g, ping) || stop_wanted()) return;
    // A waiting thread must not start a second ping, because each ping holds the surface of its transmission
    // or the signals of all its elements.
    try {
      if (survey.loaded_scene->surface_mesh || survey.loaded_scene->is_tiled() || has_signals)
        tbb::this_task_arena::isolate([&] { process(g, ping); });
      else
        process(g, ping);
    } catch (const Interrupted&) {
      return;
    }
    progress.step();
    if (progress_options.watch != nullptr) ++progress_options.watch->pings;
  };
  const PingOrder order = ping_order_of(layout);
  const auto take_at = [&](std::size_t place) {
    const auto [group, ping] = order[place];
    take(group, ping);
  };
  if (!survey.loaded_scene->is_tiled()) {
    tbb::parallel_for(std::size_t{0}, order.size(), take_at);
    return;
  }
  // Takes the pings one after another, so that all threads work on few regions at a time.
  std::atomic<std::size_t> next{0};
  tbb::parallel_for(
      0, tbb::this_task_arena::max_concurrency(),
      [&](int) {
        for (std::size_t place = next++; place < order.size() && !tbb::is_current_task_group_canceling();
             place = next++)
          take_at(place);
      },
      tbb::simple_partitioner());
}

void simulate(const Survey& survey, const RunRequest& request, PingStore& store,
              const ProgressOptions& progress_options) {
  const PingSimulation simulation(survey, request);
  PingBufferPool spare;
  for_each_ping(
      survey, layout_of(survey, request),
      [&](std::size_t group, std::size_t ping) { return !store.done(group, ping); },
      [&](std::size_t group, std::size_t ping) {
        simulation.run_into(store, {group, ping}, spare);
      },
      progress_options);
}

SimulationStats totals(const Survey& survey, const PingStore& store, const Selection& selection) {
  SimulationStats stats;
  PingCounts worst;
  const std::vector<ChosenEchoes> chosen = chosen_of(survey, selection);
  for (std::size_t g = 0; g < survey.transmissions.size(); ++g) {
    const std::size_t first = first_ping(survey.transmissions[g], chosen);
    std::size_t sensors = 0, pings = 0;
    for (const std::size_t s : survey.transmissions[g].sensors) {
      if (chosen[s].pings == 0) continue;
      ++sensors;
      pings = chosen[s].pings;
    }
    for (std::size_t ping = 0; ping < pings; ++ping) {
      const PingCounts& counts = store.counts(g, ping);
      stats.pings += sensors;
      stats.tubes += counts.tubes;
      stats.candidates += counts.candidates;
      stats.footprints += counts.footprints;
      stats.pieces += counts.pieces;
      stats.hits += counts.hits;
      stats.refined_facets += counts.refined_facets;
      stats.finer_relief_largest = std::max(stats.finer_relief_largest, counts.finer_relief_largest);
      stats.finer_relief_rms = std::max(stats.finer_relief_rms, counts.finer_relief_rms);
      add_counts(stats.refraction, counts.refraction);
      stats.shadowed_pings += counts.refraction.in_shadow > 0 ? sensors : 0;
      stats.images += counts.images;
      stats.arrivals += counts.arrivals;
      std::transform(counts.energy_of_order.begin(), counts.energy_of_order.end(),
                     stats.energy_of_order.begin(), stats.energy_of_order.begin(), std::plus<>());
      stats.visibility_seconds += counts.visibility_seconds;
      stats.echo_seconds += counts.echo_seconds;
      if (counts.worst_ratio > worst.worst_ratio) stats.reference.worst_ping = first + ping;
      keep_worst(worst, counts);
    }
  }
  stats.reference.bins_over = worst.bins_over;
  stats.reference.worst_ratio = worst.worst_ratio;
  stats.reference.worst_beam = static_cast<int>(worst.worst_beam);
  stats.reference.worst_sample = static_cast<int>(worst.worst_sample);
  if (worst.worst_ratio > 0)
    stats.reference.worst_sensor = survey.sensors[worst.worst_sensor].sensor->description().name;
  return stats;
}

std::vector<Recording> recordings_of(const Survey& survey, const std::shared_ptr<PingStore>& store,
                                     const Selection& selection) {
  std::vector<Recording> recordings;
  const std::vector<ChosenEchoes> chosen = chosen_of(survey, selection);
  for (std::size_t s = 0; s < chosen.size(); ++s) {
    if (chosen[s].pings == 0) continue;
    Recording& recording = recordings.emplace_back(recording_of(survey, s, selection, chosen[s]));
    recording.keeper = store;
    for (const OutputChannel& channel : store->channels(s)) {
      RecordedChannel recorded = recorded_channel(store, s, channel.name);
      if (channel.name == "energy") {
        recording.energy = recorded.values;
        recording.packed_energy = std::move(recorded.packed);
      } else if (channel.name == "energy_bound") {
        recording.energy_bound = recorded.values;
        recording.packed_bound = std::move(recorded.packed);
      } else {
        for (std::size_t k = 0; k < channel.variables.size(); ++k)
          recording.further.push_back(
              {channel.variables[k], recorded, k, channel.chunks, channel.values / channel.chunks});
      }
    }
    if (chosen[s].all_beams && surfaces_are_known(survey, s))
      recording.surfaces = [survey, store, s, first = chosen[s].first_ping](std::size_t ping) {
        const Sensor& sensor = *survey.sensors[s].sensor;
        const std::size_t cells = sensor.beams().size() * static_cast<std::size_t>(sensor.samples().count);
        const std::shared_ptr<const double> received = store->values(ping, {s, "energy"});
        return samples_with_surfaces(survey, s, first + ping, {received.get(), cells});
      };
  }
  attach_signals(recordings, survey, chosen, store);
  return recordings;
}

std::vector<Recording> simulate(const Survey& survey, const RunRequest& request, SimulationStats& stats,
                                const ProgressOptions& progress_options) {
  const auto store = std::make_shared<PingStore>(layout_of(survey, request));
  simulate(survey, request, *store, progress_options);
  stop_if_wanted();
  stats = totals(survey, *store, request.selection);
  return recordings_of(survey, store, request.selection);
}

}  // namespace tubefoot
