// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>

#include "sensors/recordings/recording.hpp"

namespace tubefoot {

/// Across-track angle of a beam from the sensor's downward axis, positive to starboard.
double across_angle_rad(const BeamAxis& axis);
/// Direction of a beam at such an angle, in the sensor's frame.
glm::dvec3 across_direction(double across_angle_rad);

/// The axis of a beam of a fan across the track, at the time of reception of a range bin.
struct BeamRay {
  /// The place of the receiver across the track and that of the transmitter along the track, with the
  /// attitude of the transmitter.
  Pose pose;
  glm::dvec3 axis;        ///< direction in the frame of `pose`
  double across_rad = 0;  ///< steered angle across the track, in the frame of the receiver
  double tilt_rad = 0;    ///< steered tilt of the transmit sector, in the frame of the transmitter
  /// False if the sine of the recorded angle across the track exceeds 1 (Recording::steering_ratio). The
  /// angle is then 90 degrees.
  bool has_angle = true;
  glm::dvec3 from_middle_m{0};  ///< the place of `pose` relative to the middle of transmitter and receiver

  /// Returns the range from `pose` of the point of the ray that has a range from the middle.
  double range_from_pose_m(double range_m) const;
};

/// Returns the ray along which a beam receives a range bin. A transmit sector is a cone about the forward
/// axis of the transmitter. A receive beam is a plane through the forward axis of the receiver, with the
/// steered angle across the track. The direction of the ray is their common line. It is the tilted axis of
/// the beam if the sonar neither steers its beams nor moves during a ping.
BeamRay ray_of_beam(const Recording& recording, std::size_t ping, std::size_t beam, std::size_t sample);

}  // namespace tubefoot
