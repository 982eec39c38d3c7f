// SPDX-License-Identifier: GPL-3.0-or-later
#include "sensors/recordings/navigation.hpp"

#include <algorithm>
#include <cmath>

namespace tubefoot {
namespace {

std::vector<EarthPlace> places(const Recording& recording, const RunContext& run, std::size_t first,
                               std::size_t count) {
  std::vector<glm::dvec3> points;
  points.reserve(count);
  for (std::size_t ping = first; ping < first + count; ++ping)
    points.push_back(recording.ping_pose[ping].position_m);
  if (run.frame.is_georeferenced()) return on_earth(run.frame, points, recording.sensor->description().place);
  std::vector<EarthPlace> places(count);
  for (std::size_t k = 0; k < count; ++k) places[k].lon_lat_height.z = points[k].z;
  return places;
}

}  // namespace

glm::dvec3 velocity_m_s(const Recording& recording, std::size_t ping) {
  const PingSpan line = recording.line_of(ping);
  const std::size_t before = ping > line.first ? ping - 1 : ping, after = std::min(ping + 1, line.end - 1);
  const double seconds = recording.ping_time_s[after] - recording.ping_time_s[before];
  if (!(seconds > 0)) return glm::dvec3(0);
  return (recording.ping_pose[after].position_m - recording.ping_pose[before].position_m) / seconds;
}

const NavigationFix& NavigationTrack::of(std::size_t ping) {
  constexpr std::size_t most = 4096;
  if (ping < first_ || ping >= first_ + block_.size()) {
    first_ = ping;
    block_ = navigation(recording_, run_, first_, std::min(most, recording_.pings() - first_));
  }
  return block_[ping - first_];
}

std::vector<NavigationFix> navigation(const Recording& recording, const RunContext& run, std::size_t first,
                                      std::size_t count) {
  const std::vector<EarthPlace> on_earth = places(recording, run, first, count);
  std::vector<NavigationFix> fixes(count);
  for (std::size_t k = 0; k < count; ++k) {
    const glm::dmat3& turn = on_earth[k].to_east_north_up;
    const glm::dvec3 velocity = turn * velocity_m_s(recording, first + k);
    NavigationFix& fix = fixes[k];
    fix.unix_time_s = run.start_unix_s + recording.ping_time_s[first + k];
    fix.place = on_earth[k];
    fix.lie = true_angles_of(recording.ping_pose[first + k].attitude, turn);
    fix.speed_m_s = std::hypot(velocity.x, velocity.y);
    fix.course_deg = fix.speed_m_s > 0 ? azimuth_deg(velocity.x, velocity.y) : fix.lie.heading_deg;
  }
  return fixes;
}

}  // namespace tubefoot
