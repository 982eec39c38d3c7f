// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "sensors/model/sensor.hpp"

namespace tubefoot {

/// Returns the sensor as its software assumes it, with the assumed mounting (SensorDescription::assumed).
/// Its ranges are multiplied by `range_ratio`, the assumed sound speed relative to the true one.
std::shared_ptr<const Sensor> assumed_sensor(const Sensor& sensor, double range_ratio);

}  // namespace tubefoot
