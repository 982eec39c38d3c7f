// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/water/water_column.hpp"
#include "sensors/model/assumed_sensor.hpp"
#include "sensors/model/sensor.hpp"

namespace tubefoot {

/// All pings of one sensor: times and poses of the sensor itself.
struct SensorPings {
  std::shared_ptr<const Sensor> sensor;  ///< never null
  std::vector<double> times_s;
  std::vector<std::size_t> line_starts;         ///< first ping of each line of a survey; empty: not divided
  std::vector<Pose> poses;                      ///< at the times of the pings
  std::vector<SteeredPose> transmission_poses;  ///< [ping][transmission], each at its own time
  /// [ping][transmission], at the time of reception, for a separate receiver; otherwise empty
  std::vector<SteeredPose> receiver_poses;
  /// Sound speed at the sensor's first position, or the scene's in isovelocity water. Slant ranges are
  /// travel times multiplied by this speed.
  double sound_speed_m_s = 1500;
  /// By transmission, with the absorption of the transmission. Empty in isovelocity water, in which rays are
  /// straight.
  std::vector<std::shared_ptr<const WaterColumn>> water;
  // The assumed configuration (recorded_navigation.hpp). Each default means that it is the true one.
  std::vector<Pose> recorded_poses;           ///< [ping][transmission]
  std::vector<Pose> recorded_receiver_poses;  ///< the same at reception, if the receiver moves during a ping
  std::vector<double> water_level_errors_m;   ///< by ping
  std::shared_ptr<const Sensor> assumed_sensor;  ///< null: the true one
  double assumed_sound_speed_m_s = 0;            ///< for ranges; 0: sound_speed_m_s
  double steering_sound_speed_m_s = 0;           ///< for angles of beams; 0: that of the water
  /// altitudes above the terrain vertically below; NaN where there is none
  std::vector<double> altitudes_m;

  const SteeredPose& transmission_pose(std::size_t ping, std::size_t transmission) const {
    return transmission_poses.at(ping * sensor->transmissions() + transmission);
  }
  const SteeredPose& receiver_pose(std::size_t ping, std::size_t transmission) const {
    return receiver_poses.empty() ? transmission_pose(ping, transmission)
                                  : receiver_poses.at(ping * sensor->transmissions() + transmission);
  }
};

/// Sensors that send the same tubes from the same positions at the same times. They share one history.
struct SharedTransmissions {
  std::vector<std::size_t> sensors;  ///< indices into SensorSet::sensors
};

/// The sensors of a scene and their pings.
struct SensorSet {
  std::vector<SensorPings> sensors;
  std::vector<SharedTransmissions> transmissions;

  std::size_t pings(const SharedTransmissions& group) const {
    return sensors[group.sensors.front()].times_s.size();
  }
  std::size_t transmissions_per_ping(const SharedTransmissions& group) const {
    return sensors[group.sensors.front()].sensor->transmissions();
  }
  /// Returns the group that contains a sensor's transmissions.
  const SharedTransmissions& transmissions_of(std::size_t sensor) const;
  /// Returns the index of the sensor with that name. Throws UsageError naming the most similar names.
  std::size_t sensor_named(const std::string& name) const;
  /// Returns some pings of one sensor, by their numbers, as a sensor set of their own.
  SensorSet some_pings(std::size_t sensor, const std::vector<std::size_t>& pings) const;
};

}  // namespace tubefoot
