// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/recordings/pose_angles.hpp"

#include <cmath>
#include <glm/mat3x3.hpp>

#include "sensors/model/angles.hpp"

namespace tubefoot {

double azimuth_deg(double east, double north) {
  double azimuth = degrees(std::atan2(east, north));
  if (azimuth < 0) azimuth += 360;
  constexpr double rounding_deg = 1e-8;  // a rounding error below zero becomes 360 here
  if (azimuth > 360 - rounding_deg) azimuth = 0;
  return azimuth + 0.0;
}

PoseAngles angles_of(const glm::dquat& attitude) { return true_angles_of(attitude, glm::dmat3(1)); }

PoseAngles true_angles_of(const glm::dquat& attitude, const glm::dmat3& to_east_north_up) {
  const glm::dmat3 axes = glm::mat3_cast(glm::normalize(attitude));
  const auto starboard = to_east_north_up * axes[0], forward = to_east_north_up * axes[1],
             up = to_east_north_up * axes[2];
  // A map preserves the vertical direction and scales horizontal ones.
  const glm::dvec3 unit = to_east_north_up[2] == glm::dvec3(0, 0, 1) ? axes[1] : forward;
  const bool vertical = std::hypot(unit.x, unit.y) < 1e-9;
  // On a map that is not conformal, the direction perpendicular to starboard is computed on the map.
  const glm::dvec3 ahead = vertical ? to_east_north_up * glm::dvec3(-axes[0].y, axes[0].x, 0) : forward;
  return {azimuth_deg(ahead.x, ahead.y), degrees(std::atan2(unit.z, std::hypot(unit.x, unit.y))),
          vertical ? 0 : degrees(std::atan2(-starboard.z, up.z))};
}

}  // namespace tubefoot
