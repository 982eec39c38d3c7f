// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "engine/paths/path_echo.hpp"
#include "run/sensor_set.hpp"
#include "scene/scene.hpp"

// This header declares the paths of a run other than the direct path to a facet and back
// (docs/environment.md, docs/environment.md).
namespace tubefoot {

/// Returns the settings of the paths in addition to the direct echo. Empty for a scene without mirrors and
/// without second scatterings.
std::optional<PathSettings> path_settings(const Scene& scene, double frequency_khz);

class Transmission;

/// Returns the path settings of one transmission of a sensor, at the frequency of the transmission.
std::optional<PathSettings> path_settings(const Transmission& transmission, std::size_t sensor);

/// Directions in which paths of a transmission may meet relief that is refined for it.
struct PathLook {
  TubeSet tubes;  ///< tubes of an apex, or of its image
  double beam_rad = 0;
};
/// Returns the tubes of both apexes and of their images, as if nothing except mirrors hid the facets. With
/// several scatterings, adds tubes in all directions. Empty without paths. Throws InputError if there are
/// too many images.
std::vector<PathLook> looks_of_paths(const Transmission& transmission);

/// Converts the std::length_error of path_echo() or looks_of_paths() to an InputError about a sensor.
InputError too_many_images(const SensorDescription& sensor, const std::length_error& error);
/// Returns a material with facets that are mirrors and not horizontal, if there is one.
std::optional<std::size_t> material_of_inclined_mirrors(const Scene& scene);

/// Throws InputError for paths that the scene cannot have: several orders without a mirror, or sensors above
/// the sea.
void check_paths(const Scene& scene, const SensorSet& sensor_set);

}  // namespace tubefoot
