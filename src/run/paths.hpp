// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "engine/paths/path_echo.hpp"
#include "run/sensor_set.hpp"
#include "scene/scene.hpp"

// Paths of a run besides the straight one to a facet and back (docs/paths.md, docs/bistatic.md).
namespace tubefoot {

/// What has to be followed besides the ordinary echo: nothing in a scene without mirrors.
std::optional<PathSettings> path_settings(const Scene& scene, double frequency_khz);

class Transmission;

/// Where paths of a transmission may meet relief that is refined for it.
struct PathLook {
  TubeSet tubes;  ///< of an apex, or of its image
  double beam_rad = 0;
};
/// Of both apexes and of their images, as if nothing but mirrors stood in the way; with several scatterings
/// also all round. None without paths. Throws InputError where there are too many images.
std::vector<PathLook> looks_of_paths(const Transmission& transmission);

/// What path_echo()'s and looks_of_paths()'s std::length_error says of a sensor.
InputError too_many_images(const SensorDescription& sensor, const std::length_error& error);
/// A material with facets that are mirrors and not level, if there is one.
std::optional<std::size_t> material_of_inclined_mirrors(const Scene& scene);

/// Throws InputError for paths that the scene cannot have: several orders without a mirror, sensors above the
/// sea.
void check_paths(const Scene& scene, const SensorSet& sensor_set);

}  // namespace tubefoot
