// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "engine/gradient/echo_gradient.hpp"
#include "run/contributions.hpp"
#include "run/gradient_parameters.hpp"
#include "run/ping_sums.hpp"
#include "run/transmission.hpp"

// This header declares the derivatives of energies by parameters of the scene (docs/gradients.md). Each
// parameter is an output channel of every sensor. References also have a channel of bounds.
namespace tubefoot {

/// Returns the output channels of the derivatives that a run requests, with `cells` values per ping.
std::vector<OutputChannel> gradient_channels(const SceneDescription& description, const RunRequest& request,
                                             std::size_t cells);

/// Throws UsageError if the run requests derivatives that a sensor or an object does not permit. The table
/// of abilities.hpp contains all other reasons.
void require_gradients(const Survey& survey, const RunRequest& request);

/// Rotation vector of the sonar, in the local frame, for a change of one mounting angle: 0 yaw, 1 tilt,
/// 2 roll. `attitude`: of the sonar.
glm::dvec3 mounting_axis(const Sensor& sensor, const glm::dquat& attitude, int angle);

/// Adds the derivatives of a transmission's energies.
void add_gradients(const EchoContribution& plan, const Transmission& transmission, PingSums& sums);

}  // namespace tubefoot
