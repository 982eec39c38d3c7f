// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace tubefoot {

/// Estimates the remaining time of work in equal steps from the times at which its steps ended. Times are in
/// seconds since the start of the work.
///
/// The estimate uses the second half of the finished steps, so that single work before the first step does
/// not count. There is no estimate before a tenth of the steps is finished. That half must also contain two
/// steps per thread, or last as long as the first step took. Until then the duration of a step is not
/// visible, because several threads may finish their steps together.
class TimeLeft {
 public:
  /// `afterwards_s`: approximate duration of the work after the last step.
  TimeLeft(std::size_t total, int threads, double afterwards_s = 0)
      : total_(total), threads_(static_cast<std::size_t>(threads)), afterwards_s_(afterwards_s) {}

  void step(double at_s);
  std::optional<double> seconds(double now_s) const;

 private:
  std::size_t total_, threads_, done_ = 0, stride_ = 1;
  double afterwards_s_, first_s_ = 0, last_s_ = 0;
  /// end times of every stride-th step, with its number from 1
  std::vector<std::pair<std::size_t, double>> times_;
};

/// Estimates the remaining time from the total duration only. Returns nothing before a tenth of the work is
/// finished, or if there is only one step.
std::optional<double> time_left(std::size_t done, std::size_t total, double seconds);

}  // namespace tubefoot
