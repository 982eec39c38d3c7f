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

/// Between a run and somebody who waits for it on another thread, and may stop it (geometry/steps/stop.hpp).
struct RunWatch {
  std::atomic<std::size_t> pings{0}, total{0};  ///< finished, and to do
};

/// Progress on stderr: a bar with an estimate of the time left on a terminal, a plain line every tenth
/// otherwise, nothing if quiet. There is no estimate before a tenth is done (TimeLeft). Where one step takes
/// long, also how far the work within it is (Steps of geometry/steps/steps.hpp): at the bar's end, or in
/// plain lines that come ever less often. Thread-safe.
class Progress {
 public:
  /// `afterwards_s`: what is done after the last step takes about so long, and is left, too.
  Progress(std::string what, std::size_t total, bool quiet, double afterwards_s = 0);
  /// Of work whose steps are reported by others: of those at hand.
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
