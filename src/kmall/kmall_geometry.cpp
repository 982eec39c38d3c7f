// SPDX-License-Identifier: GPL-3.0-or-later
#include "kmall/kmall_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "engine/water/eigenray.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

/// One end of the path of a sounding.
struct PathEnd {
  glm::dvec3 apex_m;  ///< from the reference point, z down
  glm::dvec3 axis;    ///< of the array
  double sine;        ///< of the angle between the cone and the plane perpendicular to the axis
};

/// Direction and travel time of the ray between an end and a point.
struct Ray {
  glm::dvec3 direction;
  double time_s;
};

std::optional<Ray> ray_to(const PathEnd& end, glm::dvec3 point_m, double waterline_m,
                          const WaterColumn& water) {
  const glm::dvec2 level(point_m.x - end.apex_m.x, point_m.y - end.apex_m.y);
  const double range_m = glm::length(level);
  const double depth_m = end.apex_m.z - waterline_m;
  if (depth_m < 0 || point_m.z <= end.apex_m.z) return {};
  const EigenrayFinder finder(water, depth_m);
  const std::optional<Eigenray> ray = finder.direct(point_m.z - waterline_m, range_m);
  if (!ray) return {};
  const glm::dvec2 heading = range_m > 0 ? level / range_m : glm::dvec2(0);
  return Ray{{heading * ray->launch_cosine, ray->launch_sine}, ray->time_s};
}

}  // namespace

glm::dmat3 rotation_of(double roll_deg, double pitch_deg, double heading_deg) {
  return glm::mat3_cast(glm::angleAxis(glm::radians(heading_deg), glm::dvec3(0, 0, 1)) *
                        glm::angleAxis(glm::radians(pitch_deg), glm::dvec3(0, 1, 0)) *
                        glm::angleAxis(glm::radians(roll_deg), glm::dvec3(1, 0, 0)));
}

glm::dvec3 arm_of(const KmallMounting& mounting, std::size_t sub_array) {
  return mounting.position_m + rotation_of(mounting) * mounting.phase_centres_m.at(sub_array);
}

SoundSpeedProfile profile_at(const KmallSurvey& survey, double transducer_depth_m, double sound_speed_m_s) {
  constexpr double least_step_m = 0.01;
  const double top_m = std::max(transducer_depth_m, 0.0);
  std::vector<ProfilePoint> points{{top_m, sound_speed_m_s}};
  for (const KmallSoundSpeed& point : survey.profile)
    if (point.depth_m > points.back().depth_m + least_step_m && point.sound_speed_m_s > 0)
      points.push_back({point.depth_m, point.sound_speed_m_s});
  return points.size() == 1 ? SoundSpeedProfile(sound_speed_m_s) : SoundSpeedProfile(points);
}

double transducer_depth_m(const KmallSurvey& survey, const KmallPing& ping) {
  const std::optional<KmallMotion> motion = motion_at(survey.motion, ping.time_s);
  const glm::dmat3 attitude = motion ? rotation_of(motion->roll_deg, motion->pitch_deg, 0) : glm::dmat3(1);
  return (attitude * arm_of(*survey.installation.transmitters.at(ping.transmitter))).z - ping.waterline_m;
}

std::optional<glm::dvec3> recomputed(const KmallSurvey& survey, const KmallPing& ping,
                                     const KmallSounding& sounding, const WaterColumn& water) {
  const KmallSector& sector = ping.sectors.at(sounding.sector);
  const KmallMounting& transmitter = *survey.installation.transmitters.at(ping.transmitter);
  const KmallMounting& receiver = *survey.installation.receivers.at(ping.receiver);
  const double sent_s = ping.time_s + sector.delay_s, received_s = sent_s + sounding.two_way_travel_time_s;
  const auto at_ping = motion_at(survey.motion, ping.time_s), sent = motion_at(survey.motion, sent_s),
             back = motion_at(survey.motion, received_s);
  if (!at_ping || !sent || !back) return {};
  const auto end = [&](const KmallMotion& motion, const KmallMounting& mounting, std::size_t part,
                       glm::dvec3 axis, double sine) {
    const glm::dmat3 attitude =
        rotation_of(motion.roll_deg, motion.pitch_deg, motion.heading_deg - ping.heading_deg);
    return PathEnd{attitude * arm_of(mounting, part) + glm::dvec3(0, 0, motion.heave_m - at_ping->heave_m),
                   attitude * (rotation_of(mounting) * axis), sine};
  };
  const PathEnd transmit =
      end(*sent, transmitter, sector.sub_array, {1, 0, 0}, std::sin(glm::radians(sector.tilt_deg)));
  // Angles of beams are positive to port.
  const PathEnd receive =
      end(*back, receiver, 1, {0, 1, 0}, -std::sin(glm::radians(sounding.angle_re_receiver_deg)));
  // Newton's method from the point that straight rays from one apex would reach. The derivatives are those of
  // straight rays.
  const glm::dvec3 down = glm::normalize(glm::cross(transmit.axis, receive.axis));
  const double overlap = glm::dot(transmit.axis, receive.axis);
  const double a = (transmit.sine - overlap * receive.sine) / (1 - overlap * overlap),
               b = (receive.sine - overlap * transmit.sine) / (1 - overlap * overlap);
  const glm::dvec3 level = a * transmit.axis + b * receive.axis;
  const double rest = 1 - glm::dot(level, level);
  if (!(rest > 0)) return {};
  glm::dvec3 direction = level + std::sqrt(rest) * (down.z > 0 ? down : -down);
  const double speed_m_s = ping.sound_speed_m_s;
  glm::dvec3 point =
      (transmit.apex_m + receive.apex_m) / 2.0 + direction * (speed_m_s * sounding.two_way_travel_time_s / 2);
  constexpr int most_steps = 12;
  constexpr double exact_m = 1e-5;
  for (int step = 0; step < most_steps; ++step) {
    const std::optional<Ray> out = ray_to(transmit, point, ping.waterline_m, water),
                             in = ray_to(receive, point, ping.waterline_m, water);
    if (!out || !in) return {};
    const double out_m = glm::distance(point, transmit.apex_m), in_m = glm::distance(point, receive.apex_m);
    const glm::dvec3 error{glm::dot(out->direction, transmit.axis) - transmit.sine,
                           glm::dot(in->direction, receive.axis) - receive.sine,
                           (out->time_s + in->time_s - sounding.two_way_travel_time_s) * speed_m_s};
    const auto gradient = [](const PathEnd& path, glm::dvec3 d, double length_m) {
      return (path.axis - glm::dot(path.axis, d) * d) / length_m;
    };
    const glm::dmat3 rows(gradient(transmit, out->direction, out_m), gradient(receive, in->direction, in_m),
                          out->direction + in->direction);
    const glm::dvec3 change = glm::inverse(glm::transpose(rows)) * error;
    point -= change;
    if (!(glm::length(change) < 1e6)) return {};
    if (glm::length(change) < exact_m) return point;
  }
  return {};
}

KmallResiduals residuals_of(const KmallSurvey& survey) {
  std::vector<double> distances_m;
  // A sample of the pings suffices, and a long line would take minutes.
  const std::size_t step = survey.pings.size() / most_checked_pings + 1;
  for (std::size_t k = 0; k < survey.pings.size(); k += step) {
    const KmallPing& ping = survey.pings[k];
    stop_if_wanted();
    const auto is_described = [](const auto& heads, std::size_t head) {
      return head < heads.size() && heads[head];
    };
    if (!is_described(survey.installation.transmitters, ping.transmitter) ||
        !is_described(survey.installation.receivers, ping.receiver))
      continue;
    const WaterColumn water{profile_at(survey, transducer_depth_m(survey, ping), ping.sound_speed_m_s), {}};
    for (const KmallSounding& sounding : ping.soundings)
      if (sounding.is_valid)
        if (const std::optional<glm::dvec3> point = recomputed(survey, ping, sounding, water))
          distances_m.push_back(glm::distance(*point, {sounding.x_m, sounding.y_m, sounding.z_m}));
  }
  if (distances_m.empty()) return {};
  std::ranges::sort(distances_m);
  const auto at = [&](double share) {
    return distances_m[static_cast<std::size_t>(share * static_cast<double>(distances_m.size() - 1))];
  };
  constexpr double most = 0.95;
  return {distances_m.size(), at(0.5), at(most)};
}

}  // namespace tubefoot
