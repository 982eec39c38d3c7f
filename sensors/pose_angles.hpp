// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/trajectory.hpp"

namespace tubefoot {

/// A pose's attitude as files keep it [deg]: heading clockwise from north, pitch forward axis up, roll
/// starboard down.
struct PoseAngles {
  double heading_deg = 0, pitch_deg = 0, roll_deg = 0;
};

/// The inverse of attitude_from_angles: heading in [0, 360), pitch in [-90, 90], roll in (-180, 180].
/// Looking straight up or down, heading and roll are one turn: all of it is called heading.
PoseAngles angles_of(const glm::dquat& attitude);

}  // namespace tubefoot
