// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/mat3x3.hpp>

#include "scene/trajectory.hpp"

namespace tubefoot {

/// A pose's attitude in the convention of files [deg]: heading clockwise from north, pitch forward axis up,
/// roll starboard down.
struct PoseAngles {
  double heading_deg = 0, pitch_deg = 0, roll_deg = 0;
};

/// The inverse of attitude_from_angles: heading in [0, 360), pitch in [-90, 90], roll in (-180, 180]. For a
/// vertical forward axis heading and roll are the same rotation; the result assigns all of it to heading.
PoseAngles angles_of(const glm::dquat& attitude);

/// The same relative to true north and the Earth's vertical, with the frame's axes as in EarthPlace. These
/// angles accompany a latitude and a longitude.
PoseAngles true_angles_of(const glm::dquat& attitude, const glm::dmat3& to_east_north_up);

/// Azimuth of a direction to the east and north, clockwise from north, in [0, 360).
double azimuth_deg(double east, double north);

}  // namespace tubefoot
