// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run/loaded_scene.hpp"
#include "run/sensor_set.hpp"

// Facets that no sonar tells apart, taken away: docs/coarse.md.
namespace tubefoot {

/// By facet of the loaded scene's mesh, grid units: the least that any sensor tells apart on it, over all
/// transmissions: a sample of range, or the width of the narrowest beam at the facet's nearest point,
/// whichever is less. 0 for facets out of every transmission's reach.
std::vector<double> resolved_lengths_m(const LoadedScene& loaded_scene, const SensorSet& sensor_set);

/// In place of the loaded scene's facets: fewer, of which no point is moved by more than `tolerance` times
/// what is resolved there, nor turned by more than the square root of the tolerance in radians. What comes
/// near another component or material, in space or by a border, moves half the way there at most. Not on
/// sites whose facets are to be resolved later (abilities.hpp): they stay as they are.
void coarsen(LoadedScene& loaded_scene, const SensorSet& sensor_set, double tolerance);

}  // namespace tubefoot
