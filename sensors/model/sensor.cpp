// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/model/sensor.hpp"

#include <cmath>
#include <numbers>

#include "sensors/model/angles.hpp"
#include "sensors/model/didson.hpp"
#include "sensors/model/echosounder.hpp"
#include "sensors/model/imaging.hpp"
#include "sensors/model/interferometric.hpp"
#include "sensors/model/multibeam.hpp"
#include "sensors/model/pattern_file.hpp"
#include "sensors/model/sidescan.hpp"

namespace tubefoot {
namespace {

/// Nothing for "none", else the pattern's table or a null pointer.
std::optional<std::shared_ptr<const PatternTable>> opened(const PatternDescription& pattern) {
  if (pattern.pattern == "none") return std::nullopt;
  if (!pattern.file) return std::shared_ptr<const PatternTable>();
  try {
    return std::make_shared<const PatternTable>(read_pattern_file(*pattern.file));
  } catch (const InputError& error) {
    throw InputError(pattern.file_place, error.what());
  }
}

/// Direction of a beam's axis in the sensor's frame.
glm::dvec3 direction_of(const BeamAxis& axis) {
  const double level = std::cos(axis.elevation_rad);
  return {level * std::sin(axis.azimuth_rad), level * std::cos(axis.azimuth_rad),
          std::sin(axis.elevation_rad)};
}

}  // namespace

Sensor::Sensor(SensorDescription description) : description_(std::move(description)) {
  require(description_.pings >= 1, description_, "pings", description_.pings, "1 or more");
  transmit_ = opened(description_.transmit);
  receive_ = opened(description_.receive);
}

TubeSet Sensor::tubes(const Pose& sensor_pose, const WorldGrid& grid, std::size_t shot) const {
  TubeSet set;
  set.apex = grid.snap(sensor_pose.position_m);
  set.reach = reach(grid);
  const glm::dmat3 turn = glm::mat3_cast(glm::normalize(sensor_pose.attitude));
  for (const AngularGrid& sector : shots_.at(shot).sectors)
    append_tubes(set, {sector.azimuth_edges_rad, sector.elevation_edges_rad, turn * sector.frame});
  return set;
}

Directivity Sensor::directivity(const PatternDescription& pattern,
                                const std::shared_ptr<const PatternTable>& table, const Fan& fan,
                                glm::dvec3 beam_axis, const glm::dmat3& turn, double sound_speed_m_s) const {
  using Kind = Directivity::Kind;
  Directivity made;
  made.kind = pattern.pattern == "line"       ? Kind::line
              : pattern.pattern == "piston"   ? Kind::piston
              : pattern.pattern == "gaussian" ? Kind::gaussian
                                              : Kind::table;
  made.from_axis = made.kind == Kind::piston || pattern.angle == "off_axis";
  const glm::dvec3 own = made.from_axis                 ? beam_axis
                         : pattern.angle == "elevation" ? fan.elevation
                                                        : fan.azimuth;
  made.axis = glm::normalize(turn * own);
  if (!made.from_axis) made.centre = glm::dot(own, beam_axis);
  const double wavelength_m = sound_speed_m_s / (frequency_khz_ * 1000);
  if (made.kind == Kind::line) made.size = *pattern.aperture_m / wavelength_m;
  if (made.kind == Kind::piston) made.size = std::numbers::pi * *pattern.aperture_m / wavelength_m;
  if (made.kind == Kind::gaussian) made.size = radians(*pattern.width_deg);
  made.table = table;
  return made;
}

BeamPatterns Sensor::patterns(const Pose& sensor_pose, double sound_speed_m_s, std::size_t shot) const {
  const Shot& fired = shots_.at(shot);
  const glm::dmat3 turn = glm::mat3_cast(glm::normalize(sensor_pose.attitude));
  BeamPatterns made;
  made.receive.resize(fired.beams.size());
  for (const Fan& fan : fired.fans) {
    made.transmit.emplace_back();
    if (transmit_) {
      std::vector<glm::dvec3> axes{fan.axis};
      if (fan.sent_by_beams) axes.clear();
      for (std::uint32_t beam = fan.first_beam; fan.sent_by_beams && beam < fan.end_beam; ++beam)
        axes.push_back(direction_of(beams_[fired.beams[beam]]));
      made.transmit.back().beams.clear();
      for (const glm::dvec3 axis : axes)
        made.transmit.back().beams.push_back(
            directivity(description_.transmit, *transmit_, fan, axis, turn, sound_speed_m_s));
    }
    if (receive_)
      for (std::uint32_t beam = fan.first_beam; beam < fan.end_beam; ++beam)
        made.receive[beam] = directivity(description_.receive, *receive_, fan,
                                         direction_of(beams_[fired.beams[beam]]), turn, sound_speed_m_s);
    if (has_staff())
      made.fringes.push_back({glm::normalize(turn * fan.staff), baseline_m_,
                              2 * std::numbers::pi * frequency_khz_ * 1000 / sound_speed_m_s});
  }
  made.fan_of_tube = fan_of_tube(shot);
  for (std::size_t tube = 0; tube < made.fan_of_tube.size(); ++tube) {
    const Fan& fan = fired.fans[made.fan_of_tube[tube]];
    const std::uint32_t own = fired.beam_of_tube[tube];
    if (receive_)
      made.beams_of_tube.emplace_back(fan.first_beam, fan.end_beam);
    else
      made.beams_of_tube.emplace_back(own, own + 1);
  }
  return made;
}

double Sensor::reach(const WorldGrid& grid) const {
  // Half a path is no shorter than the range from the transmitter less a quarter of the baseline.
  return (samples_.first_m + samples_.count * samples_.step_m + baseline_m_ / 2) / grid.unit_m();
}

Pose Sensor::mounted_at(const std::array<double, 3>& arm, const Pose& carrier) const {
  const glm::dquat mounting = attitude_from_angles(
      radians(description_.yaw_deg), -radians(description_.tilt_deg), radians(description_.roll_deg));
  return {carrier.position_m + carrier.attitude * glm::dvec3(arm[0], arm[1], arm[2]),
          glm::normalize(carrier.attitude * mounting)};
}

Pose Sensor::pose_on(const Pose& carrier) const { return mounted_at(description_.lever_arm_m, carrier); }

Pose Sensor::receiver_pose_on(const Pose& carrier) const {
  return mounted_at(description_.receiver_arm_m.value_or(description_.lever_arm_m), carrier);
}

std::vector<std::uint32_t> Sensor::fan_of_tube(std::size_t shot) const {
  std::vector<std::uint32_t> fans;
  for (std::uint32_t fan = 0; fan < shots_.at(shot).fans.size(); ++fan)
    fans.resize(shots_[shot].fans[fan].end_tube, fan);
  return fans;
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
    std::unique_ptr<Sensor> operator()(const MultibeamDescription&) const {
      return std::make_unique<Multibeam>(sensor);
    }
    std::unique_ptr<Sensor> operator()(const ImagingDescription&) const {
      return std::make_unique<Imaging>(sensor);
    }
    std::unique_ptr<Sensor> operator()(const EchosounderDescription&) const {
      return std::make_unique<Echosounder>(sensor);
    }
    std::unique_ptr<Sensor> operator()(const InterferometricDescription&) const {
      return std::make_unique<Interferometric>(sensor);
    }
  };
  std::unique_ptr<Sensor> made = std::visit(Maker{description}, description.kind);
  made->refuse_narrow();
  return made;
}

}  // namespace tubefoot
