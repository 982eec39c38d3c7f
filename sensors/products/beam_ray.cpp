// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/products/beam_ray.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "sensors/model/angles.hpp"

namespace tubefoot {

double across_angle_rad(const BeamAxis& axis) {
  if (axis.tilt_rad != 0) {
    const glm::dvec3 direction = beam_direction(axis);
    return std::atan2(glm::dot(direction, starboard_axis), -glm::dot(direction, up_axis));
  }
  return std::copysign(std::numbers::pi / 2 + axis.elevation_rad, axis.azimuth_rad);
}

glm::dvec3 across_direction(double across_angle_rad) {
  return std::sin(across_angle_rad) * starboard_axis - std::cos(across_angle_rad) * up_axis;
}

BeamRay ray_of_beam(const Recording& recording, std::size_t ping, std::size_t beam, std::size_t sample) {
  const BeamAxis& axis = recording.sensor->beams().at(beam);
  const SteeredPose sent = recording.beam_pose(ping, beam),
                    received = recording.receive_pose(ping, beam, sample);
  double across_rad = across_angle_rad(axis) + received.across_rad;
  const double tilt_rad = axis.tilt_rad + sent.along_rad;
  bool has_angle = true;
  if (recording.steering_ratio != 1) {
    const double sine = recording.steering_ratio * std::sin(across_rad);
    has_angle = std::abs(sine) <= 1;
    across_rad = std::asin(std::clamp(sine, -1.0, 1.0));
  }
  if (sent == received && sent.across_rad == 0 && sent.along_rad == 0 &&
      (axis.tilt_rad == 0 || recording.steering_ratio == 1))
    return {sent, axis.tilt_rad != 0 ? beam_direction(axis) : across_direction(across_rad), across_rad,
            tilt_rad, has_angle};

  // The vectors are in the frame of the transmitter.
  const glm::dquat turn = glm::inverse(sent.attitude) * received.attitude;
  const glm::dvec3 in_plane = turn * across_direction(across_rad),
                   normal = turn * (std::cos(across_rad) * starboard_axis + std::sin(across_rad) * up_axis),
                   ahead = glm::normalize(forward_axis - glm::dot(forward_axis, normal) * normal),
                   abeam = glm::normalize(in_plane - glm::dot(in_plane, ahead) * ahead);
  const double cosine = std::clamp(std::sin(tilt_rad) / glm::dot(forward_axis, ahead), -1.0, 1.0);
  // The sector fixes the direction along the track from the transmitter, and the beam that across the track
  // from the receiver.
  const glm::dvec3 forward = sent.attitude * forward_axis, moved_m = received.position_m - sent.position_m,
                   start_m = received.position_m - glm::dot(moved_m, forward) * forward;
  return {{start_m, sent.attitude},
          glm::normalize(cosine * ahead + std::sqrt(1 - cosine * cosine) * abeam),
          across_rad,
          tilt_rad,
          has_angle,
          start_m - (sent.position_m + received.position_m) / 2.0};
}

double BeamRay::range_from_pose_m(double range_m) const {
  const double along_m = glm::dot(from_middle_m, pose.attitude * axis),
               beside2 = glm::dot(from_middle_m, from_middle_m) - along_m * along_m;
  return std::max(std::sqrt(std::max(range_m * range_m - beside2, 0.0)) - along_m, 0.0);
}

}  // namespace tubefoot
