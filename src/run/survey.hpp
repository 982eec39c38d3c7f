// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "run/loaded_scene.hpp"
#include "run/sensor_set.hpp"
#include "scene/tiled_scene.hpp"

namespace tubefoot {

/// A loaded scene and its sensors with their pings. Both are const and shared, so that a survey is cheap to
/// copy.
struct Survey {
  std::shared_ptr<const LoadedScene> loaded_scene;
  std::shared_ptr<const SensorSet> sensor_set;
  // Short names for the members that are used most:
  const Scene& scene = loaded_scene->scene;
  const std::vector<SensorPings>& sensors = sensor_set->sensors;
  const std::vector<SharedTransmissions>& transmissions = sensor_set->transmissions;
};

/// Which facets the pings use.
enum class Facets {
  as_given,
  /// Facets of common planes are merged (geometry/mesh/merged_planes.hpp), for callers that need energies
  /// and name no facet. This has an effect only for scenes without relief, refraction, tiles and several
  /// scatterings.
  merged
};

/// Loads the scene, builds the tree, and places the pings. The caller applies `arithmetic` and `threads`.
/// `coarseness`: tolerance to which merged facets are coarsened (coarsening.hpp); 0 means no coarsening.
/// Throws InputError, also for a sensor below the seabed. Adds warnings to the report of the scene.
std::unique_ptr<const Survey> open_survey(const SceneDescription& description,
                                          Facets facets = Facets::as_given, double coarseness = 0);

/// Returns the same pings on a loaded scene whose mesh also contains some tiles. Throws InputError if a
/// raster can no longer be read.
Survey survey_with_tiles(const Survey& survey, const TileChoice& choice);

/// Returns the absorption in dB per metre, one way, at a sensor's frequency in the scene's water.
double absorption_db_per_m(const Scene& scene, const Sensor& sensor);
/// Returns the absorption of a transmission: its own, or that of the water at its frequency.
double absorption_db_per_m(const Scene& scene, const Sensor& sensor, std::size_t transmission);

}  // namespace tubefoot
