// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "engine/echo/bistatic_echo.hpp"
#include "run/shot_ground.hpp"
#include "run/simulation.hpp"

// Sonars in water that refracts (docs/refraction.md).
namespace tubefoot {

/// Speed of sound where a sensor is first; the scene's, in even water.
double sound_speed_at(const Survey& survey, const SensorDescription& sensor, const Trajectory& trajectory);

/// Gives each sensor its water, where that refracts. Throws InputError for a sensor above the surface.
void put_into_water(Survey& survey);

EigenrayOptions eigenray_options(const Survey& survey);
Straightening straightening_of(const Survey& survey, const SensorPings& pings, glm::dvec3 apex_m);
/// As the scene asks for.
StraighteningSettings straightening_settings(const Survey& survey, const SharedShots& group, double reach_m);

/// The facets of a shot where it sees them. Throws InputError where it takes too many.
ShotGround refracted_ground_of(const Survey& survey, const SharedShots& group, std::size_t ping,
                               std::size_t shot);
ShotGround refracted_ground_of(const Survey& survey, const SharedShots& group, std::size_t ping,
                               std::size_t shot, const StraighteningSettings& settings);

/// What transmitter and receiver, apart, see together of a shot. Throws as refracted_ground_of().
struct RefractedPaths {
  ApparentPair pair;
  BistaticHistory history;
};
RefractedPaths refracted_paths_of(const Survey& survey, const SharedShots& group, std::size_t ping,
                                  std::size_t shot, const VisibilityOptions& options);

void add_counts(StraighteningCounts& counts, const ApparentGround& ground, const Survey& survey,
                const SharedShots& group, std::size_t ping, std::size_t shot);
void add_counts(StraighteningCounts& sum, const StraighteningCounts& more);

/// For stats.json.
nlohmann::ordered_json refraction_json(const Survey& survey, const SimulationStats& stats);
/// What a run has to tell of facets without, or with several, rays.
std::vector<std::string> refraction_warnings(const Survey& survey, const SimulationStats& stats);

}  // namespace tubefoot
