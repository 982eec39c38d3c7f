// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/contributions.hpp"
#include "run/sensor_set.hpp"

namespace tubefoot {

/// Adds the volume reverberation of a transmission. The computation uses tubes, also for the ray engine.
void add_volume(const EchoContribution& plan, const Transmission& transmission, PingSums& sums);
/// The same for a separate receiver.
void add_separate_volume(const EchoContribution& plan, const Transmission& transmission, PingSums& sums);

/// Throws InputError at the place of a sensor whose range bins begin at the transducer, where the volume
/// reverberation is infinite. Also throws at the place of the water if it has two heights of the sea surface.
/// Adds a warning to the report of a scene with paths over mirrors, which contain no volume scattering.
void check_volume(LoadedScene& loaded_scene, const SensorSet& sensor_set);

}  // namespace tubefoot
