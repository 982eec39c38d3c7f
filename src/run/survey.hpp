// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "run/loaded_scene.hpp"
#include "run/sensor_set.hpp"
#include "scene/tiled_scene.hpp"

namespace tubefoot {

/// A site and who pings there. Both are const, and shared: a survey is cheap to copy.
struct Survey {
  std::shared_ptr<const LoadedScene> loaded_scene;
  std::shared_ptr<const SensorSet> sensor_set;
  // What of them is asked for most:
  const Scene& scene = loaded_scene->scene;
  const std::vector<SensorPings>& sensors = sensor_set->sensors;
  const std::vector<SharedTransmissions>& transmissions = sensor_set->transmissions;
};

/// Which facets pings meet.
enum class Facets {
  as_given,
  /// With planes merged (geometry/mesh/merged_planes.hpp): for who wants energies and names no facet. Only
  /// where facets stay as they are loaded: without relief, refraction and tiles.
  merged
};

/// Loads the scene, builds the tree, lays out the pings. `arithmetic` and `threads` are the caller's
/// business. `coarseness`: of merged facets, the tolerance that they are coarsened to (coarsening.hpp); 0:
/// not at all. Throws InputError: also where a sensor lies below the seabed. Adds warnings to the scene's
/// report.
std::unique_ptr<const Survey> open_survey(const SceneDescription& description,
                                          Facets facets = Facets::as_given, double coarseness = 0);

/// The same pings on a loaded scene whose mesh has some tiles, too. Throws InputError for a raster that can
/// no longer be read.
Survey survey_with_tiles(const Survey& survey, const TileChoice& choice);

/// dB per metre, one way, for a sensor's frequency in the scene's water.
double absorption_db_per_m(const Scene& scene, const Sensor& sensor);

}  // namespace tubefoot
