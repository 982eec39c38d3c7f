// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "run/checkpoint/ping_store.hpp"
#include "run/console/progress.hpp"
#include "run/contributions.hpp"
#include "run/ping_order.hpp"
#include "run/transmission.hpp"
#include "sensors/recordings/recording.hpp"

// This header declares the simulation of a survey's pings into a store, in any order and on all threads. It
// also declares the statistics and recordings of the result.

namespace tubefoot {

class RegionalSimulation;

/// Certified error bounds of a reference run, compared with its tolerance. The worst bin is the one of the
/// largest ratio; its place counts from 0.
struct ReferenceStats {
  std::size_t bins_over = 0;  ///< number of range bins whose bound exceeds the tolerance
  double worst_ratio = 0;     ///< largest ratio of a bound to its tolerance
  std::string worst_sensor;
  std::size_t worst_ping = 0;
  int worst_beam = 0, worst_sample = 0;
};

/// Counts of a simulation, summed over its pings. Seconds are those of each ping's task, added over the
/// pings.
struct SimulationStats {
  std::size_t pings = 0, tubes = 0, candidates = 0, footprints = 0, pieces = 0, hits = 0;
  std::size_t images = 0, arrivals = 0;     ///< for paths (docs/environment.md)
  std::array<double, 9> energy_of_order{};  ///< received energy density [J/m^2] by number of interactions
  double visibility_seconds = 0, echo_seconds = 0;
  std::size_t refined_facets = 0;  ///< facets made during the run (relief with mode "online")
  /// Relative change of energies that relief finer than the facets would cause, for the worst ping
  /// (FinerRelief).
  double finer_relief_largest = 0, finer_relief_rms = 0;
  ApparentMapCounts refraction;
  std::size_t shadowed_pings = 0;  ///< number of pings of which facets in shadow were omitted
  ReferenceStats reference;
};

/// Returns the layout of a store for the selected pings of a survey, with bounds for a reference. Throws the
/// errors of chosen_of().
StoreLayout layout_of(const Survey& survey, const RunRequest& request);

/// Simulates single pings of a survey, on any thread, for one request. With a reference tolerance, stores
/// must have bounds. Its energies are then those of an ordinary run, clipped to their enclosures, unless the
/// request keeps midpoints.
class PingSimulation {
 public:
  /// Throws InputError and UsageError for features that cannot be combined (abilities.hpp).
  PingSimulation(const Survey& survey, const RunRequest& request);
  ~PingSimulation();
  PingSimulation(const PingSimulation&) = delete;
  PingSimulation& operator=(const PingSimulation&) = delete;

  /// Computes one ping of a group into `values`, for finish() of a store. `unit.ping` is an index into the
  /// selected pings of the group.
  PingCounts run(const PingUnit& unit, PingValues& values) const;
  /// Computes a ping into a store, and marks it as done.
  void run_into(PingStore& store, const PingUnit& unit, PingBufferPool& spare) const {
    spare.with([&](PingValues& values) {
      const PingCounts counts = run(unit, values);
      store.finish(unit.group, unit.ping, counts, values);
    });
  }

 private:
  void clip_to_enclosures(const PingUnit& unit, PingValues& values, PingCounts& counts) const;

  std::vector<std::vector<EchoContribution>> plan_;  ///< by group; empty for terrain that is read by tiles
  Transmissions transmissions_;
  StoreLayout layout_;
  std::vector<ChosenEchoes> chosen_;                ///< by sensor
  std::unique_ptr<RegionalSimulation> by_regions_;  ///< for terrain that is read by tiles; otherwise null
  std::unique_ptr<PingSimulation> ordinary_;        ///< computes the energies to clip, or null
  mutable PingBufferPool ordinary_buffers_;
};

/// Options of the report of a simulation's progress.
struct ProgressOptions {
  bool quiet = true;          ///< if true, nothing is printed to stderr
  RunWatch* watch = nullptr;  ///< may be null
  double afterwards_s = 0;    ///< approximate duration of the work after the last ping
};

PingOrder ping_order_of(const StoreLayout& layout);

using PingCallback = std::function<void(std::size_t group, std::size_t ping)>;
using IsPending = std::function<bool(std::size_t group, std::size_t ping)>;

/// Calls `process` for each ping of `layout` for which `is_pending` returns true. The calls come from all
/// threads and in any order, with neighbouring pings together. Returns early after a request to stop
/// (geometry/steps/stop.hpp).
void for_each_ping(const Survey& survey, const StoreLayout& layout, const IsPending& is_pending,
                   const PingCallback& process, const ProgressOptions& progress_options);

/// Simulates all pings of all sensors that `store` does not contain yet, with PingSimulation. After a
/// request to stop (geometry/steps/stop.hpp), returns early with the finished pings in the store.
void simulate(const Survey& survey, const RunRequest& request, PingStore& store,
              const ProgressOptions& progress_options);

/// Returns the sums over a store's pings, added in the order of the pings.
SimulationStats totals(const Survey& survey, const PingStore& store, const Selection& selection = {});

/// Returns one recording per selected sensor of the survey. The recordings refer to the energies in `store`
/// and keep it alive.
std::vector<Recording> recordings_of(const Survey& survey, const std::shared_ptr<PingStore>& store,
                                     const Selection& selection = {});

/// Simulates the whole survey in memory. Throws Interrupted after a request to stop.
std::vector<Recording> simulate(const Survey& survey, const RunRequest& request, SimulationStats& stats,
                                const ProgressOptions& progress_options = {});

}  // namespace tubefoot
