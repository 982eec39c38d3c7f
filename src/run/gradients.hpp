// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/gradient/echo_gradient.hpp"
#include "engine/water/apparent_map.hpp"
#include "run/contributions.hpp"
#include "run/gradient_parameters.hpp"
#include "run/ping_sums.hpp"
#include "run/transmission.hpp"
#include "sensors/recordings/recording.hpp"

// This header declares the derivatives of energies by parameters of the scene (docs/gradients.md). Each
// parameter is an output channel of every sensor. References also have a channel of bounds.
namespace tubefoot {

/// Returns the output channels of the derivatives that a run requests.
std::vector<OutputChannel> gradient_channels(const Scene& scene, const RunRequest& request, std::size_t beams,
                                             std::size_t samples);

/// Throws UsageError if the run requests derivatives that a sensor or an object does not permit. The table
/// of abilities.hpp contains all other reasons.
void require_gradients(const Survey& survey, const RunRequest& request);

/// Returns the engine's parameter for the echoes of a sensor. Empty if they do not depend on it.
std::optional<EchoParameter> engine_parameter(const GradientParameter& parameter,
                                              const Transmission& transmission, std::size_t sensor);

/// Returns the engine's parameter for a parameter of the kind `scattering`.
MaterialParameter scattering_parameter(const SceneDescription& description,
                                       const GradientParameter& parameter);

/// Returns the change of the sound speed by point of the profile, per unit of the parameter; empty: none.
std::vector<double> sound_speed_change(const GradientParameter& parameter, const SoundSpeedProfile& profile);

/// Returns the map that made the apparent surface of a transmission.
ApparentMap apparent_map_of_one(const Transmission& transmission);

/// Throws InputError if several rays lead to a visible facet. Its echoes have no derivative, and
/// mixed-eigenray returns are not differentiated.
void require_one_ray(const Transmission& transmission, const History& history);
/// Throws InputError for a derivative that is not finite in stratified water.
void require_finite(const Transmission& transmission, const std::string& parameter,
                    std::span<const double> derivatives);

/// Rotation vector of the sonar, in the local frame, for a change of one mounting angle: 0 yaw, 1 tilt,
/// 2 roll. `attitude`: of the sonar.
glm::dvec3 mounting_axis(const Sensor& sensor, const glm::dquat& attitude, int angle);

/// Returns a warning for each sensor and parameter with a step of 0. Empty for a run without steps.
std::vector<std::string> one_sided_derivatives(const std::vector<Recording>& recordings);

/// Adds the derivatives of a transmission's energies.
void add_gradients(const EchoContribution& plan, const Transmission& transmission, PingSums& sums);

}  // namespace tubefoot
