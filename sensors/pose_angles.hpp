// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/gtc/quaternion.hpp>

namespace tubefoot {

/// The inverse of attitude_from_angles: heading in [0, 360), pitch in [-90, 90], roll in (-180, 180]. Looking
/// straight up or down, heading and roll are one turn: all of it is called heading.
struct PoseAngles {
  double heading_deg, pitch_deg, roll_deg;
};
PoseAngles angles_of(const glm::dquat& attitude);

}  // namespace tubefoot
