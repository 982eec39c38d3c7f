// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "sensors/recordings/recording.hpp"
#include "sensors/recordings/run_context.hpp"

namespace tubefoot {

/// Turns travel times and directions at the sonar into places, along the rays of the run's water: straight
/// ones in uniform water, refracted ones under a sound speed profile. Ranges are travel times: of the way
/// there, times the sound speed of the recording. Reflections at the sea surface are not followed.
/// Thread-safe.
class SoundingPlacer {
 public:
  SoundingPlacer(const Recording& recording, const RunContext& run);

  /// False in uniform water.
  bool traces_rays() const { return water_ != nullptr; }
  /// Where the ray ends that leaves the sensor along `beam_axis`, a direction in the sensor's frame, after
  /// the time of `range_m`. Throws std::invalid_argument as sounding_position() does.
  glm::dvec3 place(const Pose& sensor_pose, glm::dvec3 beam_axis, double range_m) const;
  /// The greatest height on that ray.
  double highest_m(const Pose& sensor_pose, glm::dvec3 beam_axis, double range_m) const;
  /// The longest that such a ray can be.
  double longest_m(double range_m) const { return range_m * fastest_ratio_; }
  /// At the sensor.
  double sound_speed_m_s(const Pose& sensor_pose) const;

 private:
  double depth_m(const Pose& sensor_pose) const {
    return water_->surface_height_m() - sensor_pose.position_m.z;
  }

  std::shared_ptr<const SceneWater> water_;  ///< null: uniform
  double sound_speed_m_s_;                   ///< of the recording
  double fastest_ratio_ = 1;                 ///< the largest sound speed of the water over that
};

}  // namespace tubefoot
