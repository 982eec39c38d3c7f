// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sensors/model/sensor.hpp"

namespace tubefoot {

/// Sound speeds at the transducer that determine recorded ranges and angles.
struct AssumedSpeeds {
  double true_m_s = 1500;      ///< true sound speed
  double range_m_s = 1500;     ///< assumed for ranges
  double steering_m_s = 1500;  ///< assumed for the steering of beams
};

/// A sensor as its software assumes it.
struct AssumedSensor {
  std::shared_ptr<const Sensor> sensor;
  /// Beams whose recorded angle does not exist, because its sine exceeds 1. Their angle is 90 degrees.
  std::vector<std::uint32_t> beams_without_angle;
};

/// Returns the sensor with its assumed mounting (SensorDescription::assumed). Its ranges grow in proportion
/// to the assumed sound speed. In a fan across the track, a beam at the true angle theta from the array's
/// normal gets the angle asin(sin(theta) steering / true).
AssumedSensor assumed_sensor(const Sensor& sensor, const AssumedSpeeds& speeds);

}  // namespace tubefoot
