// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "run/console/time_left.hpp"

namespace tubefoot {

/// Connection between a run and another thread that waits for it and may stop it (geometry/steps/stop.hpp).
struct RunWatch {
  std::atomic<std::size_t> pings{0}, total{0};  ///< pings that are finished, and pings in total
};

/// Shows progress on stderr. On a terminal it draws a bar with an estimate of the remaining time. Otherwise
/// it prints a line after every tenth of the steps. It prints nothing if quiet. The estimate starts after a
/// tenth of the steps (TimeLeft). During a long step it also shows the progress within the step (Steps of
/// geometry/steps/steps.hpp). This progress stands at the end of the bar, or in lines at increasing
/// intervals. Thread-safe.
class Progress {
 public:
  /// `afterwards_s`: approximate duration of the work after the last step, which the remaining time
  /// includes.
  Progress(std::string what, std::size_t total, bool quiet, double afterwards_s = 0);
  /// Shows the progress of work that other code reports as Steps.
  Progress(std::string what, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void step();

 private:
  using Clock = std::chrono::steady_clock;

  struct Kind {
    bool of_steps;
  };
  Progress(std::string what, std::size_t total, bool quiet, double afterwards_s, Kind kind);
  void draw(Clock::time_point now);
  void draw_bar(const std::string& of, std::size_t done, std::size_t total, std::optional<double> left_s,
                const std::string& more);
  void look_within();

  std::string what_;
  std::size_t total_, finished_ = 0, shown_tenths_ = 0;
  bool quiet_, of_steps_, terminal_, over_ = false;
  Clock::time_point start_, drawn_, stepped_;
  TimeLeft left_;
  std::mutex mutex_;
  std::condition_variable ended_;
  std::thread within_;
};

}  // namespace tubefoot
