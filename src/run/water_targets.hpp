// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "engine/targets/target_draws.hpp"
#include "run/contributions.hpp"
#include "run/sensor_set.hpp"
#include "run/transmission.hpp"

// This header declares the targets in the water of a scene (docs/environment.md): their checks before a run,
// and their contribution to energies. Their signals are part of signals_received().

namespace tubefoot {

/// Largest expected number of targets of a population, and of all populations in the sector of a
/// transmission. In stratified water, each target needs a search for eigenrays.
constexpr double most_targets_of_population = 5e8, most_targets_of_transmission = 1e7,
                 most_targets_of_refracted_transmission = 1e5;
/// Largest expected number of values in the signals of populations in a ping. It is the number of targets
/// times that of receivers times that of samples in a pulse.
constexpr double most_target_signal_values = 1e10;

/// Returns whether the scene has targets in the water.
bool has_water_targets(const SceneDescription& description);

/// Loads the targets of a scene on its grid, with the tables of their strengths. Throws InputError at the
/// line of an invalid table, or at the place of a target.
std::shared_ptr<const WaterTargets> load_water_targets(const Scene& scene);

/// Checks the targets before a run, while the loaded scene contains whole bodies. Throws InputError for
/// - a target on a facet, below the terrain, inside a closed object or above the sea surface; moving objects
///   count at the first ping,
/// - a population whose box ends above the sea surface,
/// - a table that lacks the frequency of a sensor,
/// - more targets than the limits above.
/// Adds a warning to the report of a scene with paths over mirrors, which do not lead to targets.
void check_water_targets(LoadedScene& loaded_scene, const SensorSet& sensor_set);

/// Adds the echoes of targets that a transmission insonifies, for energies and their references.
void add_water_targets(const EchoContribution& plan, const Transmission& transmission, PingSums& sums);

/// Returns the distances from the transmitter at which the group's sensors may receive a target.
TargetReach target_reach(const Transmission& transmission);

/// Returns the InputError for a target at the position of a sensor, at the place of the target or population.
InputError target_at_sensor(const Transmission& transmission, const WaterTarget& target);

}  // namespace tubefoot
