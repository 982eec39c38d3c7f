// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "run/kept/ping_store.hpp"
#include "run/shot.hpp"

// Sonars in water that refracts (docs/refraction.md).
namespace tubefoot {

struct SimulationStats;

/// Speed of sound where a sensor is first; the scene's, in even water.
double sound_speed_at(const Scene& scene, const SensorDescription& sensor, const Trajectory& trajectory);

/// Gives each sensor its water, where that refracts. Throws InputError for a sensor above the surface.
void put_into_water(Site& site, Fleet& fleet);

EigenrayOptions eigenray_options(const Site& site);
Straightening straightening_of(const Site& site, const SensorPings& pings, glm::dvec3 apex_m);
/// As the scene asks for.
StraighteningSettings straightening_settings(const Shot& shot, double reach_m);

/// The facets of a shot where it sees them. Throws InputError where it takes too many.
ShotGround refracted_ground_of(const Shot& shot, bool weights = false);
ShotGround refracted_ground_of(const Shot& shot, const StraighteningSettings& settings, bool weights = false);

/// The facets of a shot where transmitter and receiver, apart, see them, and how they look at them. Throws as
/// refracted_ground_of().
struct RefractedPair {
  ApparentPair pair;
  std::vector<FacetId> parent;  ///< by facet of pair.mesh that the transmitter may see: the scene's
  std::array<TubeSet, 2> tubes;
  std::array<Straightening, 2> water;
  double absorption_db_per_m = 0;

  /// What both see together.
  BistaticHistory trace(const Shot& shot) const;
};
RefractedPair refracted_pair_of(const Shot& shot, bool weights = false);

/// What transmitter and receiver, apart, see together of a shot. Throws as refracted_ground_of().
struct RefractedPaths {
  ApparentPair pair;
  BistaticHistory history;
};
RefractedPaths refracted_paths_of(const Shot& shot);

void add_counts(StraighteningCounts& counts, const ApparentGround& ground, const Shot& shot);
void add_counts(StraighteningCounts& sum, const StraighteningCounts& more);

/// For stats.json.
nlohmann::ordered_json refraction_json(const Survey& survey, const SimulationStats& stats);
/// What a run has to tell of facets without, or with several, rays.
std::vector<std::string> refraction_warnings(const Survey& survey, const SimulationStats& stats);

}  // namespace tubefoot
