// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/motion_within_ping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "files/input_error.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/recordings/pose_angles.hpp"

namespace tubefoot {
namespace {

/// Rotation between two attitudes.
double angle_between_rad(const glm::dquat& a, const glm::dquat& b) {
  const glm::dquat turn = glm::inverse(a) * b;
  return 2 * std::atan2(glm::length(glm::dvec3(turn.x, turn.y, turn.z)), std::abs(turn.w));
}

/// Width of the narrowest beam in the direction in which the receiver resolves beams.
double narrowest_beam_rad(const Sensor& sensor) {
  double narrowest = std::numeric_limits<double>::infinity();
  for (const BeamAxis& beam : sensor.beams())
    narrowest =
        std::min(narrowest, sensor.is_across_track() ? beam.elevation_width_rad : beam.azimuth_width_rad);
  return narrowest;
}

glm::dvec3 horizontal_forward(const glm::dquat& attitude) {
  const glm::dvec3 forward = attitude * forward_axis;
  return {forward.x, forward.y, 0};
}

/// Mean heading about a time, as a horizontal unit vector.
glm::dvec3 mean_heading(const Trajectory& trajectory, double at_s, double window_s) {
  constexpr int steps = 20;
  // Between two lines the boat turns.
  double begin_s = trajectory.begin_s(), end_s = trajectory.end_s();
  for (const Trajectory::Line& line : trajectory.lines())
    if (at_s >= line.begin_s && at_s <= line.end_s) {
      begin_s = line.begin_s;
      end_s = line.end_s;
    }
  glm::dvec3 sum(0);
  for (int k = 0; k <= steps; ++k) {
    const double time_s = at_s + window_s * (static_cast<double>(k) / steps - 0.5);
    sum += horizontal_forward(trajectory.at(std::clamp(time_s, begin_s, end_s)).attitude);
  }
  return sum;
}

/// Returns the tilt of a sector at which its middle has the angle `wanted_rad` from the vertical plane across
/// `heading`. The tilt t is the solution of cos t A + sin t B = sin(wanted). A is the component along the
/// heading of the direction across the track, and B is that of the forward axis.
double stabilised_tilt_rad(const glm::dquat& attitude, double across_rad, const glm::dvec3& heading,
                           double wanted_rad) {
  const glm::dvec3 across =
      attitude * (std::sin(across_rad) * starboard_axis - std::cos(across_rad) * up_axis);
  const double a = glm::dot(heading, across), b = glm::dot(heading, attitude * forward_axis),
               length = std::hypot(a, b);
  if (!(length > std::abs(std::sin(wanted_rad)))) return wanted_rad;  // no tilt has this angle
  return std::asin(std::sin(wanted_rad) / length) - std::atan2(a, b);
}

struct Steering {
  double across_rad = 0, along_rad = 0;
};

Steering steering(const Sensor& sensor, const Trajectory& trajectory, double at_s, std::size_t transmission) {
  const Sensor::Stabilisation& by = sensor.stabilisation();
  if (!by.any()) return {};
  glm::dquat carrier = trajectory.at(at_s).attitude;
  const PoseAngles angles = angles_of(carrier);
  Steering made;
  const double facing = std::cos(radians(sensor.description().yaw_deg)) < 0 ? -1 : 1;
  if (by.roll) made.across_rad = facing * radians(angles.roll_deg);
  if (!by.pitch && !by.yaw) return made;
  const glm::dvec3 heading =
      by.yaw ? mean_heading(trajectory, at_s, by.heading_window_s) : horizontal_forward(carrier);
  if (!(glm::length(heading) > 0)) return made;  // a vertical forward axis has no heading
  if (!by.pitch) carrier = attitude_from_angles(radians(angles.heading_deg), 0, radians(angles.roll_deg));
  const SectorAxis axis = sensor.sector_axis(transmission);
  made.along_rad = stabilised_tilt_rad(carrier * sensor.mounting(), axis.across_rad + made.across_rad,
                                       facing * glm::normalize(heading), axis.along_rad) -
                   axis.along_rad;
  constexpr double most_deg = 60;
  if (const double tilt_deg = degrees(axis.along_rad + made.along_rad); std::abs(tilt_deg) > most_deg)
    throw InputError(
        sensor.description().place,
        fmt::format("the stabilisation of sensor '{}' needs a tilt of {:.3g} degrees along the track at "
                    "{:.9g} s, and at most {:g} degrees are possible: use a trajectory that turns less, or "
                    "leave out 'stabilisation'",
                    sensor.description().name, tilt_deg, at_s, most_deg));
  return made;
}

/// Angle of a direction in the sensor's frame that its beams resolve.
double resolved_angle_rad(const Sensor& sensor, const glm::dvec3& direction) {
  return sensor.is_across_track() ? std::atan2(direction.x, -direction.z)
                                  : std::atan2(direction.x, direction.y);
}

}  // namespace

std::optional<Sensor::Division> division_of_record(const Sensor& sensor, const Trajectory& trajectory,
                                                   const std::vector<double>& times_s,
                                                   double sound_speed_m_s) {
  if (trajectory.is_fixed()) return std::nullopt;
  constexpr int parts = 16;
  const RangeSamples& samples = sensor.samples();
  const double first_s = 2 * samples.first_m / sound_speed_m_s,
               end_s = 2 * samples.border_m(samples.count) / sound_speed_m_s,
               part_s = (end_s - first_s) / parts;
  double change_rad = 0;  // largest change within a part of the record
  Sensor::Division division{1, sound_speed_m_s, 0};
  for (const double ping_s : times_s)
    for (std::size_t firing = 0; firing < sensor.firings(); ++firing) {
      const double sent_s = ping_s + sensor.transmission_delay_s(firing);
      if (!trajectory.holds(sent_s + end_s))
        throw InputError(
            sensor.description().place,
            fmt::format(
                "sensor '{}' moves during reception (stop_and_hop = false): the record of the ping at "
                "{:.9g} s ends at {:.9g} s, but the trajectory ends at {:.9g} s: use fewer pings, a "
                "shorter range or a longer trajectory",
                sensor.description().name, ping_s, sent_s + end_s, trajectory.end_s()));
      const glm::dquat sent = sensor.receiver_pose_on(trajectory.at(sent_s)).attitude;
      Pose before = sensor.receiver_pose_on(trajectory.at(sent_s + first_s));
      for (int k = 1; k <= parts; ++k) {
        const Pose now = sensor.receiver_pose_on(trajectory.at(sent_s + first_s + k * part_s));
        // A point in the middle of the part changes its direction by the displacement over its range.
        const double range_m = samples.first_m + (k - 0.5) / parts * samples.count * samples.step_m;
        change_rad = std::max(change_rad, angle_between_rad(before.attitude, now.attitude) +
                                              glm::distance(before.position_m, now.position_m) / range_m);
        division.largest_turn_rad =
            std::max(division.largest_turn_rad, angle_between_rad(sent, now.attitude));
        before = now;
      }
    }
  if (change_rad == 0) return std::nullopt;
  const double wanted =
      std::ceil(parts * change_rad / (sensor.description().motion_step_beams * narrowest_beam_rad(sensor)));
  division.intervals = static_cast<int>(std::clamp(wanted, 1.0, static_cast<double>(samples.count)));
  // The transmitter of a carrier that turns over insonifies no more than this.
  constexpr double largest_deg = 45;
  division.largest_turn_rad = std::min(division.largest_turn_rad, radians(largest_deg));
  return division;
}

SteeredPose steered_pose(const Sensor& sensor, const Trajectory& trajectory, double at_s,
                         std::size_t transmission) {
  const Steering made = steering(sensor, trajectory, at_s, transmission);
  return {sensor.pose_on(trajectory.at(at_s)), made.across_rad, made.along_rad};
}

SteeredPose steered_receiver_pose(const Sensor& sensor, const Trajectory& trajectory, double at_s,
                                  std::size_t transmission) {
  const Steering made = steering(sensor, trajectory, at_s, transmission);
  return {sensor.receiver_pose_on(trajectory.at(at_s)), made.across_rad,
          sensor.receiver_moves() ? 0 : made.along_rad};
}

std::optional<std::string> motion_warning(const SensorPings& pings, const Trajectory& trajectory) {
  constexpr double allowed_beams = 0.1;
  const Sensor& sensor = *pings.sensor;
  if (trajectory.is_fixed() || sensor.receiver_moves() || sensor.signals() != nullptr ||
      sensor.description().look_at_m)
    return {};
  const std::vector<BeamAxis>& beams = sensor.beams();
  const double width_rad = narrowest_beam_rad(sensor),
               end_m = sensor.samples().border_m(sensor.samples().count);
  const std::array<std::size_t, 3> looked_at{0, beams.size() / 2, beams.size() - 1};
  double worst_beams = allowed_beams;
  std::size_t worst_ping = 0, worst_beam = 0;
  for (std::size_t ping = 0; ping < pings.times_s.size(); ++ping)
    for (const std::size_t beam : looked_at) {
      const BeamAxis& axis = beams[beam];
      const SteeredPose& sent = pings.transmission_pose(ping, 0);
      const glm::dvec3 own = beam_direction(axis), direction = sent.attitude * own;
      double range_m = end_m;
      if (direction.z < 0 && pings.altitudes_m[ping] > 0)
        range_m = std::min(range_m, pings.altitudes_m[ping] / -direction.z);
      const double received_s = pings.times_s[ping] + 2 * range_m / pings.sound_speed_m_s;
      if (!trajectory.holds(received_s)) continue;
      const SteeredPose received = steered_receiver_pose(sensor, trajectory, received_s, 0);
      // The displacement of the carrier moves echoes by at most half of it, whatever the beam width.
      const glm::dvec3 seen = glm::inverse(received.attitude) * direction;
      const double turn_rad = std::remainder(resolved_angle_rad(sensor, seen) - received.across_rad -
                                                 resolved_angle_rad(sensor, own) + sent.across_rad,
                                             2 * std::numbers::pi);
      if (std::abs(turn_rad) / width_rad <= worst_beams) continue;
      worst_beams = std::abs(turn_rad) / width_rad;
      worst_ping = ping;
      worst_beam = beam;
    }
  if (worst_beams == allowed_beams) return {};
  return fmt::format(
      "{}: sensor '{}' stands still during a ping (stop_and_hop = true), but at the reception of ping {}, "
      "beam "
      "{} is displaced by {:.2g} beam widths: set stop_and_hop = false to include the motion",
      to_string(sensor.description().place), sensor.description().name, worst_ping, worst_beam, worst_beams);
}

}  // namespace tubefoot
