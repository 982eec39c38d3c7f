// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/water/water_column.hpp"
#include "sensors/model/sensor.hpp"

namespace tubefoot {

/// All pings of one sensor: times and poses of the sensor itself.
struct SensorPings {
  std::shared_ptr<const Sensor> sensor;  ///< never null
  std::vector<double> times_s;
  std::vector<std::size_t> line_starts;  ///< first ping of each line of a survey; empty: not divided
  std::vector<Pose> poses;               ///< at the pings' times
  std::vector<Pose> transmission_poses;  ///< [ping][transmission], each at its own time
  std::vector<Pose> receiver_poses;      ///< [ping][transmission], of a receiver that is apart; else empty
  /// At its first place; the scene's, in isovelocity water. Travel times times this are slant ranges.
  double sound_speed_m_s = 1500;
  std::shared_ptr<const WaterColumn>
      water;                        ///< with absorption at its frequency; null: even, rays are straight
  std::vector<double> altitudes_m;  ///< above the terrain straight below; not a number where there is none

  const Pose& transmission_pose(std::size_t ping, std::size_t transmission) const {
    return transmission_poses.at(ping * sensor->transmissions() + transmission);
  }
  const Pose& receiver_pose(std::size_t ping, std::size_t transmission) const {
    return receiver_poses.empty() ? transmission_pose(ping, transmission)
                                  : receiver_poses.at(ping * sensor->transmissions() + transmission);
  }
};

/// Sensors that fire the same tubes from the same places at the same times: one history serves them all.
struct SharedTransmissions {
  std::vector<std::size_t> sensors;  ///< indices into Fleet::sensors
};

/// Who pings where.
struct SensorSet {
  std::vector<SensorPings> sensors;
  std::vector<SharedTransmissions> transmissions;

  std::size_t pings(const SharedTransmissions& group) const {
    return sensors[group.sensors.front()].times_s.size();
  }
  std::size_t transmissions_per_ping(const SharedTransmissions& group) const {
    return sensors[group.sensors.front()].sensor->transmissions();
  }
  /// The group of a sensor's transmissions.
  const SharedTransmissions& transmissions_of(std::size_t sensor) const;
  /// Index of the sensor of that name; throws UsageError naming the nearest ones.
  std::size_t sensor_named(const std::string& name) const;
  /// Some pings of one sensor, by their numbers, as a sensor set of its own.
  SensorSet some_pings(std::size_t sensor, const std::vector<std::size_t>& pings) const;
};

}  // namespace tubefoot
