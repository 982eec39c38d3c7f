// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/model/assumed_sensor.hpp"

namespace tubefoot {
namespace {

class SensorAsAssumed : public Sensor {
 public:
  SensorAsAssumed(const Sensor& sensor, double range_ratio) : Sensor(sensor) {
    const AssumedMountingDescription& assumed = description_.assumed;
    description_.yaw_deg = assumed.yaw_deg.value_or(description_.yaw_deg);
    description_.tilt_deg = assumed.tilt_deg.value_or(description_.tilt_deg);
    description_.roll_deg = assumed.roll_deg.value_or(description_.roll_deg);
    if (assumed.lever_arm_m) {
      // The distance between transmitter and receiver is known.
      if (description_.receiver_arm_m)
        for (std::size_t k = 0; k < 3; ++k)
          (*description_.receiver_arm_m)[k] += (*assumed.lever_arm_m)[k] - description_.lever_arm_m[k];
      description_.lever_arm_m = *assumed.lever_arm_m;
    }
    samples_.first_m *= range_ratio;
    samples_.step_m *= range_ratio;
  }
};

}  // namespace

std::shared_ptr<const Sensor> assumed_sensor(const Sensor& sensor, double range_ratio) {
  return std::make_shared<const SensorAsAssumed>(sensor, range_ratio);
}

}  // namespace tubefoot
