// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/model/assumed_sensor.hpp"

#include <cmath>
#include <numbers>

namespace tubefoot {
namespace {

constexpr double quarter_turn_rad = std::numbers::pi / 2;

class SensorAsAssumed : public Sensor {
 public:
  SensorAsAssumed(const Sensor& sensor, const AssumedSpeeds& speeds,
                  std::vector<std::uint32_t>& beams_without_angle)
      : Sensor(sensor) {
    const AssumedMountingDescription& assumed = description_.assumed;
    description_.yaw_deg = assumed.yaw_deg.value_or(description_.yaw_deg);
    description_.tilt_deg = assumed.tilt_deg.value_or(description_.tilt_deg);
    description_.roll_deg = assumed.roll_deg.value_or(description_.roll_deg);
    description_.lever_arm_m = assumed.lever_arm_m.value_or(description_.lever_arm_m);
    if (speeds.range_m_s != speeds.true_m_s) {
      const double ratio = speeds.range_m_s / speeds.true_m_s;
      samples_.first_m *= ratio;
      samples_.step_m *= ratio;
    }
    if (speeds.steering_m_s != speeds.true_m_s && sensor.is_across_track())
      for (std::uint32_t beam = 0; beam < beams_.size(); ++beam) {
        BeamAxis& axis = beams_[beam];
        const glm::dvec3 direction = beam_direction(axis);
        const double level = std::cos(axis.tilt_rad),
                     true_sine =
                         axis.tilt_rad == 0 ? std::cos(axis.elevation_rad) : std::abs(direction.x) / level,
                     sine = true_sine * speeds.steering_m_s / speeds.true_m_s;
        if (sine > 1) beams_without_angle.push_back(beam);
        const double across_rad = std::asin(std::fmin(sine, 1));
        if (axis.tilt_rad == 0) {
          axis.elevation_rad = across_rad - quarter_turn_rad;
        } else {  // the tilted axis stays on the cone of its transmit sector
          axis.azimuth_rad =
              std::atan2(level * std::copysign(std::sin(across_rad), direction.x), std::sin(axis.tilt_rad));
          axis.elevation_rad = -std::asin(level * std::cos(across_rad));
        }
      }
  }
};

}  // namespace

AssumedSensor assumed_sensor(const Sensor& sensor, const AssumedSpeeds& speeds) {
  AssumedSensor assumed;
  assumed.sensor = std::make_shared<const SensorAsAssumed>(sensor, speeds, assumed.beams_without_angle);
  return assumed;
}

}  // namespace tubefoot
