// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace tubefoot {

/// Position (m, local east-north-up frame) and attitude: `attitude` turns body axes (x starboard, y forward,
/// z up) into the local frame.
struct Pose {
  glm::dvec3 position_m{0};
  glm::dquat attitude{1, 0, 0, 0};
};

/// Heading clockwise from north, pitch bow up, roll starboard down; radians. Identity looks north.
glm::dquat attitude_from_angles(double heading_rad, double pitch_rad, double roll_rad);

/// A pose as a function of time: a fixed pose, a line, or interpolated waypoints (positions linear, attitude
/// slerp).
class Trajectory {
 public:
  struct Sample {
    double time_s = 0;
    Pose pose;
  };
  /// A line of a survey. Between two is a turn, on which no sensor pings.
  struct Line {
    double begin_s = 0, end_s = 0;
  };
  /// At least one sample, times strictly increasing. One sample: the pose never changes. Lines within the
  /// samples' times, one after the other; none: the track is not divided.
  explicit Trajectory(std::vector<Sample> samples, std::vector<Line> lines = {});

  double begin_s() const { return samples_.front().time_s; }
  double end_s() const { return samples_.back().time_s; }
  bool is_fixed() const { return samples_.size() == 1; }
  const std::vector<Line>& lines() const { return lines_; }
  const std::vector<Sample>& samples() const { return samples_; }
  /// Whether there is a pose at a time; times of pings may miss the ends by rounding.
  bool holds(double time_s) const;
  /// Pose at a time within [begin, end] (any time if fixed). Throws std::out_of_range outside.
  Pose at(double time_s) const;

 private:
  std::vector<Sample> samples_;
  std::vector<Line> lines_;
};

}  // namespace tubefoot
