// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/loaded_scene.hpp"
#include "run/sensor_set.hpp"

// This header declares the removal of facets that no sonar resolves (docs/accuracy-and-speed.md).
namespace tubefoot {

/// Returns, by facet of the loaded scene's mesh, the smallest length that any sensor resolves on the facet,
/// in grid units, over all transmissions. This length is the range sample, or the width of the narrowest
/// beam at the nearest point of the facet, whichever is less. It is 0 for facets out of reach of every
/// transmission.
std::vector<double> resolved_lengths(const LoadedScene& loaded_scene, const SensorSet& sensor_set);

/// Replaces the facets of the loaded scene by fewer facets. No point moves by more than `tolerance` times
/// the resolved length at that point. No facet turns by more than the square root of the tolerance, in
/// radians. A facet near another component or material moves at most half of the distance to it. Not for
/// scenes whose facets must keep their identity (abilities.hpp); open_survey() leaves their facets
/// unchanged.
void coarsen(LoadedScene& loaded_scene, const SensorSet& sensor_set, double tolerance);

}  // namespace tubefoot
