// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/model/sensor.hpp"

namespace tubefoot {

/// Single beam along the sensor's down axis. A square sector about it is looked at; transmitter and receiver
/// each have their pattern, by default a Gaussian of the beam's width about the axis.
class Echosounder : public Sensor {
 public:
  /// Throws std::invalid_argument for a beam, a sector, ranges or counts that make no echosounder.
  explicit Echosounder(const SensorDescription& description);
};

}  // namespace tubefoot
