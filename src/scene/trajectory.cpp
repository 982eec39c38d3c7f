// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/trajectory.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <stdexcept>

namespace tubefoot {
namespace {

// Ping times are sums and products of decimal fractions. Rounding may shift the last ping of a line beyond
// its end.
constexpr double kTimeRounding_s = 1e-9;

}  // namespace

glm::dquat attitude_from_angles(double heading_rad, double pitch_rad, double roll_rad) {
  // Order of rotations, from the inner to the outer: roll about the forward axis, pitch about starboard,
  // then heading. The heading is clockwise, against the mathematical sense.
  return glm::angleAxis(-heading_rad, glm::dvec3(0, 0, 1)) * glm::angleAxis(pitch_rad, glm::dvec3(1, 0, 0)) *
         glm::angleAxis(roll_rad, glm::dvec3(0, 1, 0));
}

Trajectory::Trajectory(std::vector<Sample> samples, std::vector<Line> lines)
    : samples_(std::move(samples)), lines_(std::move(lines)) {
  if (samples_.empty()) throw std::invalid_argument("a trajectory needs at least one sample");
  for (std::size_t i = 1; i < samples_.size(); ++i) {
    if (!(samples_[i - 1].time_s < samples_[i].time_s)) {
      throw std::invalid_argument(fmt::format("trajectory times must increase: {} s is followed by {} s",
                                              samples_[i - 1].time_s, samples_[i].time_s));
    }
  }
  double after_s = begin_s();
  for (const auto& [line_begin_s, line_end_s] : lines_) {
    if (!(line_begin_s >= after_s && line_end_s >= line_begin_s && line_end_s <= end_s()))
      throw std::invalid_argument(
          fmt::format("the line from {} s to {} s must come after {} s, within {} s to {} s", line_begin_s,
                      line_end_s, after_s, begin_s(), end_s()));
    after_s = line_end_s;
  }
}

bool Trajectory::holds(double time_s) const {
  return is_fixed() || (time_s >= begin_s() - kTimeRounding_s && time_s <= end_s() + kTimeRounding_s);
}

Pose Trajectory::at(double time_s) const {
  if (is_fixed()) return samples_.front().pose;
  if (!holds(time_s)) {
    throw std::out_of_range(fmt::format(
        "time {} s is outside of the trajectory, which lasts from {} s to {} s", time_s, begin_s(), end_s()));
  }
  const double t = std::clamp(time_s, begin_s(), end_s());
  const auto after = std::upper_bound(samples_.begin() + 1, samples_.end() - 1, t,
                                      [](double time, const Sample& s) { return time < s.time_s; });
  const Sample& a = *(after - 1);
  const Sample& b = *after;
  const double weight = (t - a.time_s) / (b.time_s - a.time_s);
  // glm::slerp takes the shorter of the two arcs.
  return {glm::mix(a.pose.position_m, b.pose.position_m, weight),
          glm::normalize(glm::slerp(a.pose.attitude, b.pose.attitude, weight))};
}

}  // namespace tubefoot
