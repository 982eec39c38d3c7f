// SPDX-License-Identifier: GPL-3.0-or-later
// The base class of all sensors. It computes the tubes and patterns of a transmission from a pose, and the
// poses of transmitter and receiver on a carrier.

#include "sensors/model/sensor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <span>

#include "sensors/model/angles.hpp"
#include "sensors/model/pattern_file.hpp"

namespace tubefoot {
namespace {

/// Empty for the pattern "none"; otherwise its table, or a null pointer for a pattern without one.
std::optional<std::shared_ptr<const PatternTable>> opened(const PatternDescription& pattern) {
  if (pattern.pattern == "none") return std::nullopt;
  if (!pattern.file) return std::shared_ptr<const PatternTable>();
  try {
    return std::make_shared<const PatternTable>(read_pattern_file(*pattern.file));
  } catch (const InputError& error) {
    throw InputError(pattern.file_place, error.what());
  }
}

/// True if the receive patterns of a fan differ by more than rounding; equal patterns become bitwise equal.
/// A common pattern, such as a vertical one of a fan ahead, does not resolve its beams (beam_angles.hpp).
bool are_resolved(std::span<Directivity> beams) {
  constexpr double rounding = 1e-12;
  const Directivity first = beams.front();
  const bool differ = std::ranges::any_of(beams, [&](const Directivity& beam) {
    return first.from_axis ? beam.axis != first.axis : std::abs(beam.centre - first.centre) > rounding;
  });
  for (Directivity& beam : beams)
    if (!differ) beam.centre = first.centre;
  return differ;
}

}  // namespace

glm::dvec3 beam_direction(const BeamAxis& axis) {
  const double level = std::cos(axis.elevation_rad);
  return {level * std::sin(axis.azimuth_rad), level * std::cos(axis.azimuth_rad),
          std::sin(axis.elevation_rad)};
}

namespace {

/// Direction of an axis after steering of the fan.
glm::dvec3 steered(glm::dvec3 axis, const SteeredPose& pose) {
  if (pose.across_rad == 0 && pose.along_rad == 0) return axis;
  const double across_rad = std::atan2(axis.x, -axis.z) + pose.across_rad,
               along_rad = std::asin(std::clamp(axis.y, -1.0, 1.0)) + pose.along_rad;
  return std::cos(along_rad) * (std::sin(across_rad) * starboard_axis - std::cos(across_rad) * up_axis) +
         std::sin(along_rad) * forward_axis;
}

std::vector<double> turned_by(std::vector<double> edges_rad, double angle_rad) {
  if (angle_rad != 0)
    for (double& edge : edges_rad) edge += angle_rad;
  return edges_rad;
}

}  // namespace

Sensor::Sensor(SensorDescription description) : description_(std::move(description)) {
  require(description_.pings.value_or(1) >= 1, description_, "pings", description_.pings.value_or(1),
          "1 or more");
  transmit_ = opened(description_.transmit);
  receive_ = opened(description_.receive);
}

TubeSet Sensor::tubes_of(const std::vector<AngularGrid>& sectors, const SteeredPose& pose,
                         const WorldGrid& grid, std::size_t transmission) const {
  TubeSet set;
  set.apex = grid.snap(pose.position_m);
  set.reach = reach(grid, transmission);
  const glm::dmat3 turn = glm::mat3_cast(glm::normalize(pose.attitude));
  for (const AngularGrid& sector : sectors)
    append_tubes(set, {turned_by(sector.azimuth_edges_rad, pose.across_rad),
                       turned_by(sector.elevation_edges_rad, pose.along_rad), turn * sector.frame});
  return set;
}

TubeSet Sensor::tubes(const SteeredPose& sensor_pose, const WorldGrid& grid, std::size_t transmission) const {
  const Transmission& own = fired(transmission);
  return tubes_of(receiver_moves() && !own.moving_sectors.empty() ? own.moving_sectors : own.sectors,
                  sensor_pose, grid, transmission);
}

TubeSet Sensor::transmit_tubes(const SteeredPose& sensor_pose, const WorldGrid& grid,
                               std::size_t transmission) const {
  const Transmission& own = fired(transmission);
  if (receiver_moves() && !own.moving_transmitter_sectors.empty()) {
    std::vector<AngularGrid> sectors = own.moving_transmitter_sectors;
    sectors.front().azimuth_edges_rad.front() -= division_->largest_turn_rad;
    sectors.back().azimuth_edges_rad.back() += division_->largest_turn_rad;
    return tubes_of(sectors, sensor_pose, grid, transmission);
  }
  return tubes_of(own.transmitter_sectors.empty() ? own.sectors : own.transmitter_sectors, sensor_pose, grid,
                  transmission);
}

RangeSamples Sensor::samples(std::size_t transmission) const {
  if (intervals_ == 1) return samples_;
  const std::size_t first = first_sample(transmission), k = transmission % intervals_,
                    end = k + 1 == intervals_ ? static_cast<std::size_t>(samples_.count)
                                              : first_sample(transmission + 1);
  return {samples_.border_m(static_cast<double>(first)), samples_.step_m, static_cast<int>(end - first)};
}

void Sensor::divide_record(const Division& division) {
  if (division.intervals < 1 || division.intervals > samples_.count)
    throw std::invalid_argument(
        fmt::format("sensor '{}': invalid division of {} range bins into {} intervals", description_.name,
                    samples_.count, division.intervals));
  division_ = division;
  intervals_ = static_cast<std::size_t>(division.intervals);
}

double Sensor::reception_delay_s(std::size_t transmission) const {
  const double sent_s = transmission_delay_s(transmission);
  if (!division_) return sent_s;
  const RangeSamples own = samples(transmission);
  return sent_s + 2 * own.border_m(own.count / 2.0) / division_->sound_speed_m_s;
}

std::size_t Sensor::transmission_receiving(std::size_t sector, std::size_t sample) const {
  std::size_t transmission = first_transmission(sector);
  for (std::size_t k = 1; k < intervals_ && first_sample(transmission + 1) <= sample; ++k) ++transmission;
  return transmission;
}

Directivity Sensor::directivity(const PatternDescription& pattern,
                                const std::shared_ptr<const PatternTable>& table, const Fan& fan,
                                glm::dvec3 beam_axis, const glm::dmat3& turn, double wavelength_m) const {
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
  if (made.kind == Kind::line) {
    made.size = *pattern.aperture_m / wavelength_m;
    made.shading = pattern.shading;
  }
  if (made.kind == Kind::piston) made.size = std::numbers::pi * *pattern.aperture_m / wavelength_m;
  if (made.kind == Kind::gaussian) made.size = radians(*pattern.width_deg);
  made.table = table;
  return made;
}

BeamPatterns Sensor::patterns(const SteeredPose& transmitter, const SteeredPose& receiver,
                              double sound_speed_m_s, std::size_t transmission) const {
  const Transmission& own = fired(transmission);
  const glm::dmat3 transmit_turn = glm::mat3_cast(glm::normalize(transmitter.attitude)),
                   receive_turn = glm::mat3_cast(glm::normalize(receiver.attitude));
  const double frequency_khz = this->frequency_khz(transmission),
               wavelength_m = sound_speed_m_s / (frequency_khz * 1000);
  BeamPatterns made;
  made.receive.resize(own.beams.size());
  std::vector<bool> apart;  // by fan: its receive patterns resolve the beams
  for (const Fan& fan : own.fans) {
    made.transmit.emplace_back();
    if (transmit_) {
      std::vector<glm::dvec3> axes{fan.axis};
      if (fan.sent_by_beams) axes.clear();
      for (std::uint32_t beam = fan.first_beam; fan.sent_by_beams && beam < fan.end_beam; ++beam)
        axes.push_back(beam_direction(beams_[own.beams[beam]]));
      made.transmit.back().beams.clear();
      for (const glm::dvec3 axis : axes)
        made.transmit.back().beams.push_back(directivity(
            description_.transmit, *transmit_, fan, steered(axis, transmitter), transmit_turn, wavelength_m));
    }
    if (receive_) {
      for (std::uint32_t beam = fan.first_beam; beam < fan.end_beam; ++beam)
        made.receive[beam] = directivity(description_.receive, *receive_, fan,
                                         steered(beam_direction(beams_[own.beams[beam]]), receiver),
                                         receive_turn, wavelength_m);
      apart.push_back(
          are_resolved(std::span(made.receive).subspan(fan.first_beam, fan.end_beam - fan.first_beam)));
    }
    if (has_receiver_pair())
      made.baselines.push_back({glm::normalize(receive_turn * fan.receiver_pair), receiver_pair_.baseline_m,
                                2 * std::numbers::pi * frequency_khz * 1000 / sound_speed_m_s});
  }
  made.fan_of_tube = fan_of_tube(transmission);
  for (std::size_t tube = 0; tube < made.fan_of_tube.size(); ++tube) {
    const Fan& fan = own.fans[made.fan_of_tube[tube]];
    const std::uint32_t beam = own.beam_of_tube[tube];
    if (receive_ && apart[made.fan_of_tube[tube]])
      made.beams_of_tube.emplace_back(fan.first_beam, fan.end_beam);
    else
      made.beams_of_tube.emplace_back(beam, beam + 1);
  }
  return made;
}

double Sensor::reach(const WorldGrid& grid, const RangeSamples& samples) const {
  // Half a path is at least the range from the transmitter less a quarter of the baseline.
  const double apart_m = signals_ ? signals_->farthest_element_m() : receiver_pair_.baseline_m / 2;
  return (samples.first_m + samples.count * samples.step_m + apart_m) / grid.unit_m();
}

namespace {

glm::dvec3 at_arm(const std::array<double, 3>& arm, const Pose& carrier) {
  return carrier.position_m + carrier.attitude * glm::dvec3(arm[0], arm[1], arm[2]);
}

}  // namespace

glm::dquat Sensor::mounting() const {
  if (description_.look_at_m) return {1, 0, 0, 0};
  return attitude_from_angles(radians(description_.yaw_deg), -radians(description_.tilt_deg),
                              radians(description_.roll_deg));
}

glm::dquat Sensor::attitude_on(const Pose& carrier) const {
  if (!description_.look_at_m) return glm::normalize(carrier.attitude * mounting());
  const auto& [east, north, up] = *description_.look_at_m;
  const glm::dvec3 way = glm::dvec3(east, north, up) - at_arm(description_.lever_arm_m, carrier);
  const double level_m = std::hypot(way.x, way.y);
  if (!(glm::length(way) > 0))
    throw InputError(description_.place, fmt::format("sensor '{}' is at the position of 'look_at_m', so it "
                                                     "has no direction: move the sensor or 'look_at_m'",
                                                     description_.name));
  // Straight up or down there is no heading, so that the carrier's heading applies.
  const glm::dvec3 forward = carrier.attitude * forward_axis;
  const double heading = level_m > 0 ? std::atan2(way.x, way.y) : std::atan2(forward.x, forward.y);
  return attitude_from_angles(heading, std::atan2(way.z, level_m), radians(description_.roll_deg));
}

Pose Sensor::pose_on(const Pose& carrier) const {
  return {at_arm(description_.lever_arm_m, carrier), attitude_on(carrier)};
}

Pose Sensor::receiver_pose_on(const Pose& carrier) const {
  return {at_arm(description_.receiver_arm_m.value_or(description_.lever_arm_m), carrier),
          attitude_on(carrier)};
}

std::vector<std::uint32_t> Sensor::fan_of_tube(std::size_t transmission) const {
  std::vector<std::uint32_t> fans;
  const std::vector<Fan>& own = fired(transmission).fans;
  for (std::uint32_t fan = 0; fan < own.size(); ++fan) fans.resize(own[fan].end_tube, fan);
  return fans;
}

}  // namespace tubefoot
