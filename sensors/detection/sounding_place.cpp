// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/detection/sounding_place.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "engine/water/timed_ray.hpp"
#include "sensors/detection/bottom_detection.hpp"

namespace tubefoot {
namespace {

/// Direction of a unit vector with z upwards, in the vertical plane of the ray.
RayDirection in_its_plane(const glm::dvec3& direction) {
  return {-direction.z, std::hypot(direction.x, direction.y)};
}

}  // namespace

SoundingPlacer::SoundingPlacer(const Recording& recording, const RunContext& run)
    : water_(run.layered_water && run.layered_water->refracts() ? run.layered_water : nullptr),
      sound_speed_m_s_(recording.sound_speed_m_s),
      steering_m_s_(recording.steering_sound_speed_m_s) {
  if (!water_) return;
  for (const ProfilePoint& point : water_->profile().points())
    fastest_ratio_ = std::max(fastest_ratio_, point.sound_speed_m_s / sound_speed_m_s_);
}

glm::dvec3 SoundingPlacer::place(const Pose& sensor_pose, glm::dvec3 beam_axis, double range_m,
                                 double water_level_m) const {
  const glm::dvec3 straight = sounding_position(sensor_pose, beam_axis, range_m);
  if (!water_) return straight;
  const glm::dvec3 direction = glm::normalize(sensor_pose.attitude * beam_axis);
  const RayDirection launch = in_its_plane(direction);
  const double from_m = depth_m(sensor_pose, water_level_m);
  const TimedRay ray = ray_after(water_->profile(), from_m, launch, range_m / sound_speed_m_s_);
  const double across = launch.cosine > 0 ? ray.range_m / launch.cosine : 0;
  return sensor_pose.position_m +
         glm::dvec3(across * direction.x, across * direction.y, from_m - ray.depth_m);
}

double SoundingPlacer::highest_m(const Pose& sensor_pose, glm::dvec3 beam_axis, double range_m,
                                 double water_level_m) const {
  const double from_m = sensor_pose.position_m.z;
  const glm::dvec3 direction = glm::normalize(sensor_pose.attitude * beam_axis);
  if (!water_) return from_m + std::max(0.0, direction.z * range_m);
  const RayDirection launch = in_its_plane(direction);
  // By Snell's law a ray as steep as this never turns upwards.
  const double depth = depth_m(sensor_pose, water_level_m);
  if (launch.sine > 0 && launch.cosine * fastest_ratio_ * sound_speed_m_s_ < water_->profile().at(depth))
    return from_m;
  return water_->surface_height_m() + water_level_m -
         ray_after(water_->profile(), depth, launch, range_m / sound_speed_m_s_).shallowest_m;
}

double SoundingPlacer::sound_speed_m_s(const Pose& sensor_pose, double water_level_m) const {
  if (steering_m_s_ > 0) return steering_m_s_;
  return water_ ? water_->profile().at(depth_m(sensor_pose, water_level_m)) : sound_speed_m_s_;
}

}  // namespace tubefoot
