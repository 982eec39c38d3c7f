// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/sensor.hpp"

#include "sensors/angles.hpp"
#include "sensors/didson.hpp"
#include "sensors/sidescan.hpp"

namespace tubefoot {

Sensor::Sensor(SensorDescription description) : description_(std::move(description)) {
  require(description_.pings >= 1, description_, "pings", description_.pings, "1 or more");
}

TubeSet Sensor::tubes(const Pose& sensor_pose, const WorldGrid& grid) const {
  TubeSet set;
  set.apex = grid.snap(sensor_pose.position_m);
  set.reach = reach(grid);
  const glm::dmat3 turn = glm::mat3_cast(glm::normalize(sensor_pose.attitude));
  for (const AngularGrid& sector : sectors_)
    append_tubes(set, {sector.azimuth_edges_rad, sector.elevation_edges_rad, turn * sector.frame});
  return set;
}

double Sensor::reach(const WorldGrid& grid) const {
  return (samples_.first_m + samples_.count * samples_.step_m) / grid.unit_m();
}

Pose Sensor::pose_on(const Pose& carrier) const {
  const auto& arm = description_.lever_arm_m;
  const glm::dquat mounting = attitude_from_angles(
      radians(description_.yaw_deg), -radians(description_.tilt_deg), radians(description_.roll_deg));
  return {carrier.position_m + carrier.attitude * glm::dvec3(arm[0], arm[1], arm[2]),
          glm::normalize(carrier.attitude * mounting)};
}

std::vector<double> Sensor::ping_times_s() const {
  std::vector<double> times;
  for (int ping = 0; ping < description_.pings; ++ping)
    times.push_back(description_.first_ping_s + ping * description_.ping_interval_s);
  return times;
}

std::unique_ptr<Sensor> make_sensor(const SensorDescription& description) {
  struct Maker {
    const SensorDescription& sensor;
    std::unique_ptr<Sensor> operator()(const DidsonDescription&) const {
      return std::make_unique<Didson>(sensor);
    }
    std::unique_ptr<Sensor> operator()(const SidescanDescription&) const {
      return std::make_unique<Sidescan>(sensor);
    }
  };
  return std::visit(Maker{description}, description.kind);
}

}  // namespace tubefoot
