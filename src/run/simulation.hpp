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
#include "run/echo_parts.hpp"
#include "run/ping_order.hpp"
#include "run/transmission.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {

class RegionalSimulation;

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
  std::size_t images = 0, arrivals = 0;     ///< of paths (docs/paths.md)
  std::array<double, 9> energy_of_order{};  ///< by number of interactions
  double visibility_seconds = 0, echo_seconds = 0;
  std::size_t refined_facets = 0;  ///< made for transmissions, with relief online
  /// What finer relief than its facets would change (FinerRelief), of the worst ping.
  double finer_relief_largest = 0, finer_relief_rms = 0;
  ApparentMapCounts refraction;
  std::size_t shadowed_pings = 0;  ///< of which facets were left out in shadows
  ReferenceStats reference;
};

/// What has to be kept of a survey's pings, of those that are asked for; with bounds for a reference. Throws
/// as chosen_of().
StoreLayout layout_of(const Survey& survey, const RunRequest& request);

/// Simulates pings of a survey one by one, on any thread, as a request asks for them. With a reference
/// tolerance stores must keep bounds.
class PingSimulation {
 public:
  /// Throws InputError and UsageError for what cannot be combined (abilities.hpp).
  PingSimulation(const Survey& survey, const RunRequest& request);
  ~PingSimulation();
  PingSimulation(const PingSimulation&) = delete;
  PingSimulation& operator=(const PingSimulation&) = delete;

  /// Leaves the energies of a group's ping, counted among those that are asked for, in `values`, for a
  /// store's finish().
  PingCounts run(const PingUnit& unit, PingValues& values) const;
  /// The same into a store, which is done with the ping then.
  void run_into(PingStore& store, const PingUnit& unit, PingBufferPool& spare) const {
    spare.with([&](PingValues& values) {
      const PingCounts counts = run(unit, values);
      store.finish(unit.group, unit.ping, counts, values);
    });
  }

 private:
  Transmissions transmissions_;
  StoreLayout layout_;
  std::vector<ChosenEchoes> chosen_;                ///< by sensor
  std::vector<std::vector<EchoPart>> parts_;        ///< by group
  std::unique_ptr<RegionalSimulation> by_regions_;  ///< where terrain is read by tiles; else null
};

/// Who looks on while pings are simulated.
struct Onlookers {
  bool quiet = true;          ///< nothing on stderr
  RunWatch* watch = nullptr;  ///< may be null
  double afterwards_s = 0;    ///< what is done after the last ping takes about so long
};

PingOrder ping_order_of(const StoreLayout& layout);

/// Calls `keep` for each ping of `layout`, by group and ping, that is `left` to do, from all threads and in
/// any order, near ones together. Returns early when somebody wants to stop (geometry/steps/stop.hpp).
using OfPing = std::function<void(std::size_t group, std::size_t ping)>;
using IsLeft = std::function<bool(std::size_t group, std::size_t ping)>;
void for_each_ping(const Survey& survey, const StoreLayout& layout, const IsLeft& left, const OfPing& keep,
                   const Onlookers& onlookers);

/// Runs all pings of all sensors that `store` has not yet, as PingSimulation does. Returns early, with
/// what was finished in the store, when somebody wants to stop (geometry/steps/stop.hpp).
void simulate(const Survey& survey, const RunRequest& request, PingStore& store, const Onlookers& onlookers);

/// The sums over a store's pings, added in the order of the pings.
SimulationStats totals(const Survey& survey, const PingStore& store, const Selection& selection = {});

/// One recording per sensor of the survey that is asked for, of the energies in `store`, which they keep
/// alive.
std::vector<Recording> recordings_of(const Survey& survey, const std::shared_ptr<PingStore>& store,
                                     const Selection& selection = {});

/// All of it in memory. Throws Interrupted when somebody wants to stop.
std::vector<Recording> simulate(const Survey& survey, const RunRequest& request, SimulationStats& stats,
                                const Onlookers& onlookers = {});

}  // namespace tubefoot
