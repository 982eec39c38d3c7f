// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace tubefoot {

/// Estimates how long work of equal steps still takes, from the times at which its steps ended. Times are in
/// seconds since the work began.
///
/// The second half of the steps so far counts, so that what happens once before the first step does not.
/// There is no estimate before a tenth of the steps is done, nor before that half has two steps of each
/// thread, or lasted as long as it took to end the first step: until then several threads, which may end
/// their steps together, or what happens once hide how long a step takes.
class TimeLeft {
 public:
  /// `afterwards_s`: what is to be done after the last step takes about so long.
  TimeLeft(std::size_t total, int threads, double afterwards_s = 0)
      : total_(total), threads_(static_cast<std::size_t>(threads)), afterwards_s_(afterwards_s) {}

  void step(double at_s);
  std::optional<double> seconds(double now_s) const;

 private:
  std::size_t total_, threads_, done_ = 0, stride_ = 1;
  double afterwards_s_, first_s_ = 0, last_s_ = 0;
  std::vector<std::pair<std::size_t, double>> times_;  ///< of every stride-th step, with its number from 1
};

/// The same of work of which only the whole is known. Nothing before a tenth is done, and of one step.
std::optional<double> time_left(std::size_t done, std::size_t total, double seconds);

}  // namespace tubefoot
