// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "sensors/recordings/recording.hpp"
#include "sensors/recordings/run_context.hpp"

namespace tubefoot {

/// Converts travel times and directions at the sonar into positions, along the rays of the run's water. Rays
/// are straight in isovelocity water and refracted under a sound-speed profile. A range here is the one-way
/// travel time multiplied by the sound speed of the recording. The class does not follow reflections at the
/// sea surface. `water_level_m` is an error of the water level that the pose includes. The profile moves with
/// it, because depths are measured from the water. Thread-safe.
class SoundingPlacer {
 public:
  SoundingPlacer(const Recording& recording, const RunContext& run);

  /// False in isovelocity water.
  bool traces_rays() const { return water_ != nullptr; }
  /// End of the ray that leaves the sensor along `beam_axis`, after the travel time of `range_m`.
  /// `beam_axis` is a direction in the sensor's frame. Throws std::invalid_argument as sounding_position()
  /// does.
  glm::dvec3 place(const Pose& sensor_pose, glm::dvec3 beam_axis, double range_m,
                   double water_level_m = 0) const;
  /// Greatest height on that ray.
  double highest_m(const Pose& sensor_pose, glm::dvec3 beam_axis, double range_m,
                   double water_level_m = 0) const;
  /// Upper bound of the length of such a ray.
  double longest_m(double range_m) const { return range_m * fastest_ratio_; }
  /// Sound speed at the sensor for the angles of arrivals.
  double sound_speed_m_s(const Pose& sensor_pose, double water_level_m = 0) const;

 private:
  double depth_m(const Pose& sensor_pose, double water_level_m) const {
    return water_->surface_height_m() + water_level_m - sensor_pose.position_m.z;
  }

  std::shared_ptr<const SceneWater> water_;  ///< null: isovelocity
  double sound_speed_m_s_;                   ///< of the recording
  double steering_m_s_;                      ///< for angles; 0: that of the water
  double fastest_ratio_ = 1;                 ///< largest sound speed of the water relative to
                                             ///< sound_speed_m_s_
};

}  // namespace tubefoot
