// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "run/console/progress.hpp"
#include "run/run_request.hpp"
#include "run/survey.hpp"

namespace tubefoot {

/// Derivatives of the sum of weight times energy over all pings, beams and range bins of all sensors.
struct WeightedGradient {
  std::vector<glm::dvec3> by_vertex;            ///< of the scene's mesh, per metre; shared by all components
  std::vector<double> by_mu;                    ///< by Lambert's parameter of each material
  std::map<std::string, double> by_scattering;  ///< by parameters of other scattering models, by name
  double by_sound_speed = 0;  ///< per m/s, for range bins that are intervals of time, at fixed beam patterns
  double by_absorption = 0;   ///< by the one-way absorption, per dB/km
  std::map<std::string, double> by_profile;  ///< by further parameters of the sound-speed profile, by name
  struct OfSonar {
    std::vector<glm::dvec3> by_position;  ///< by ping, per metre
    std::vector<glm::dvec3> by_rotation;  ///< by ping, per radian about the sonar's own axes
    std::vector<glm::dvec3> by_mounting;  ///< by ping, per radian of yaw, tilt and roll; 0 with `look_at_m`
    std::vector<glm::dvec3> by_patterns;  ///< by ping, per radian of the patterns alone about the own axes
  };
  std::vector<OfSonar> sonars;  ///< by sensor
  struct OfObject {
    glm::dvec3 by_position{0};  ///< per metre
    glm::dvec3 by_rotation{0};  ///< per radian about its own axes through its origin
    bool moves_alone = true;    ///< false if it shares a vertex with another component
  };
  std::vector<OfObject> objects;  ///< in the order of the description
};

/// Computes the derivatives in reverse mode, in one pass over all transmissions. `weights`: by sensor,
/// [ping][beam][range bin]; empty for a sensor without weights. Requires facets that are neither merged nor
/// loaded in tiles. `watch`: counts finished pings. Throws UsageError for a wrong number of weights, for a
/// weight that is not finite, and for features without derivatives.
WeightedGradient weighted_gradient(const Survey& survey, RunRequest request,
                                   const std::vector<std::span<const double>>& weights,
                                   RunWatch* watch = nullptr);

}  // namespace tubefoot
