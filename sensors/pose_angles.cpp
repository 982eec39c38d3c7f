// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/pose_angles.hpp"

#include <cmath>

#include "sensors/angles.hpp"

namespace tubefoot {

PoseAngles angles_of(const glm::dquat& attitude) {
  const glm::dmat3 axes = glm::mat3_cast(glm::normalize(attitude));
  const glm::dvec3 starboard = axes[0], forward = axes[1], up = axes[2];
  const bool vertical = std::hypot(forward.x, forward.y) < 1e-9;
  double heading_deg =
      degrees(vertical ? std::atan2(-starboard.y, starboard.x) : std::atan2(forward.x, forward.y));
  if (heading_deg < 0) heading_deg += 360;
  if (heading_deg >= 360) heading_deg = 0;  // a rounding below zero was lifted to 360
  return {heading_deg + 0.0, degrees(std::atan2(forward.z, std::hypot(forward.x, forward.y))),
          vertical ? 0 : degrees(std::atan2(-starboard.z, up.z))};
}

}  // namespace tubefoot
