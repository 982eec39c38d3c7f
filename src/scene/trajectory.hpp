// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace tubefoot {

/// Position in m in the local east-north-up frame, and attitude. `attitude` rotates body axes (x starboard,
/// y forward, z up) into the local frame.
struct Pose {
  glm::dvec3 position_m{0};
  glm::dquat attitude{1, 0, 0, 0};
};

/// Returns the attitude of angles in radians: heading clockwise from north, pitch bow up, roll starboard
/// down. The identity faces north.
glm::dquat attitude_from_angles(double heading_rad, double pitch_rad, double roll_rad);

/// A pose as a function of time: a fixed pose, a line, or interpolated waypoints (linear in position, slerp
/// in attitude).
class Trajectory {
 public:
  struct Sample {
    double time_s = 0;
    Pose pose;
  };
  /// A line of a survey. Sensors do not ping during the turn between two lines.
  struct Line {
    double begin_s = 0, end_s = 0;
  };
  /// Requires at least one sample and strictly increasing times. With one sample, the pose is constant.
  /// Lines are in order and lie within the times of the samples. Without lines, the track is not divided.
  explicit Trajectory(std::vector<Sample> samples, std::vector<Line> lines = {});

  double begin_s() const { return samples_.front().time_s; }
  double end_s() const { return samples_.back().time_s; }
  bool is_fixed() const { return samples_.size() == 1; }
  const std::vector<Line>& lines() const { return lines_; }
  const std::vector<Sample>& samples() const { return samples_; }
  /// Returns whether there is a pose at a time. Ping times may exceed the ends by rounding.
  bool holds(double time_s) const;
  /// Returns the pose at a time within [begin, end] (any time if fixed). Throws std::out_of_range outside.
  Pose at(double time_s) const;

 private:
  std::vector<Sample> samples_;
  std::vector<Line> lines_;
};

}  // namespace tubefoot
