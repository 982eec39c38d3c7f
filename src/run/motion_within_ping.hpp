// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "run/sensor_set.hpp"
#include "scene/trajectory.hpp"
#include "sensors/model/sensor.hpp"

// This header declares the motion of a carrier between transmission and reception, and the steering of
// beams against it (docs/sensors.md).
namespace tubefoot {

/// Returns the division of the record of a ping. The direction of the receiver changes by at most
/// SensorDescription::motion_step_beams within each interval. Empty for a carrier that is at rest during all
/// pings. `times_s` are the times of the pings. Throws InputError if a record continues after the end of the
/// trajectory.
std::optional<Sensor::Division> division_of_record(const Sensor& sensor, const Trajectory& trajectory,
                                                   const std::vector<double>& times_s,
                                                   double sound_speed_m_s);

/// Returns the pose of a sensor on its carrier, with the steering that stabilises a transmission. `at_s` is
/// the time of transmission or of reception. Throws InputError if the stabilisation needs a tilt above 60
/// degrees.
///
/// Roll: the angles across the track change by the roll of the carrier, which is positive for starboard down.
/// Pitch and yaw: the sector is tilted along the track until its middle has its angle from the vertical plane
/// across the heading. Yaw stabilisation uses the mean heading on the line of the survey, and pitch
/// stabilisation alone the present heading. A sonar that is mounted backwards has the opposite roll and
/// heading.
SteeredPose steered_pose(const Sensor& sensor, const Trajectory& trajectory, double at_s,
                         std::size_t transmission);
/// The same for the receiver. A receiver that moves during a ping is steered across the track only.
SteeredPose steered_receiver_pose(const Sensor& sensor, const Trajectory& trajectory, double at_s,
                                  std::size_t transmission);

/// Returns a warning if a beam of the receiver turns by more than a tenth of its width during a ping with
/// stop and hop. Requires the altitudes of the pings.
std::optional<std::string> motion_warning(const SensorPings& pings, const Trajectory& trajectory);

}  // namespace tubefoot
