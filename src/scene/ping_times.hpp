// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scene/description/sensor_description.hpp"
#include "scene/trajectory.hpp"

namespace tubefoot {

/// Times of a sensor's pings: a list, or at equal intervals from the first ping. On the lines of a survey,
/// the pings begin again at the beginning of each line and end with it. `pings` limits their total number.
class PingTimes {
 public:
  /// Throws InputError at the sensor's place for pings outside of its trajectory. It also throws if the
  /// lines hold no pings, fewer than requested, or more than 10^7.
  PingTimes(const SensorDescription& sensor, const Trajectory& trajectory,
            const std::string& trajectory_name);

  std::size_t count() const { return count_; }
  /// Calls `take` with the time of each ping in s.
  template <class Take>
  void each(const Take& take) const {
    for (const double time_s : listed_s_) take(time_s);
    if (!listed_s_.empty()) return;
    for (std::size_t line = 0; line < starts_.size(); ++line)
      for (std::size_t ping = starts_[line]; ping < end_of(line); ++ping)
        take(first_s_[line] + static_cast<double>(ping - starts_[line]) * interval_s_);
  }
  std::vector<double> times_s() const;
  double first_s() const { return first_s_.front(); }
  /// Returns the first ping of each line of a survey that has pings; empty if the track is not divided into
  /// lines.
  std::vector<std::size_t> line_starts() const { return divided_ ? starts_ : std::vector<std::size_t>{}; }

 private:
  std::size_t end_of(std::size_t line) const {
    return line + 1 < starts_.size() ? starts_[line + 1] : count_;
  }

  std::size_t count_ = 0;
  std::vector<double> listed_s_;
  double interval_s_;
  bool divided_;
  std::vector<std::size_t> starts_;
  std::vector<double> first_s_;  ///< time of the first ping, by line
};

}  // namespace tubefoot
