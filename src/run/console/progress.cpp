// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/console/progress.hpp"

#include <fmt/format.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <system_error>

#include "geometry/steps/steps.hpp"
#include "run/console/say.hpp"

// This file draws the progress of a run on stderr, as a bar with the remaining time on a terminal or as
// plain lines elsewhere. A thread of its own updates the bar during long steps.

namespace tubefoot {
namespace {

using namespace std::chrono_literals;

/// Time after which the progress within a step is shown.
constexpr auto patience = 1s;
constexpr auto between_bars = 250ms;
/// Time without a step until the first plain line. Each further line waits twice as long.
constexpr auto first_plain_line = 2s;

std::string duration(double seconds) {
  if (seconds < 1) return "under 1 s";
  if (seconds < 60) return fmt::format("{:.0f} s", seconds);
  const auto whole = static_cast<long>(seconds + 0.5);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace

Progress::Progress(std::string what, std::size_t total, bool quiet, double afterwards_s)
    : Progress(std::move(what), total, quiet || total == 0, afterwards_s, Kind{false}) {}

Progress::Progress(std::string what, bool quiet) : Progress(std::move(what), 0, quiet, 0, Kind{true}) {}

Progress::Progress(std::string what, std::size_t total, bool quiet, double afterwards_s, Kind kind)
    : what_(std::move(what)),
      total_(total),
      quiet_(quiet),
      of_steps_(kind.of_steps),
      terminal_(isatty(STDERR_FILENO) != 0),
      start_(Clock::now()),
      drawn_(start_),
      stepped_(start_),
      left_(total, std::max(tbb::this_task_arena::max_concurrency(), 1), afterwards_s) {
  if (quiet_) return;
  if (terminal_) draw(start_);
  try {
    within_ = std::thread([this] { look_within(); });
  } catch (const std::system_error&) {
    // If no thread is available, only finished steps are reported.
  }
}

Progress::~Progress() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  ended_.notify_one();
  if (within_.joinable()) within_.join();
  if (!quiet_ && terminal_) draw_on_terminal("\r\033[K");
}

void Progress::step() {
  const std::lock_guard lock(mutex_);
  ++finished_;
  if (quiet_) return;
  const auto now = stepped_ = Clock::now();
  left_.step(std::chrono::duration<double>(now - start_).count());
  if (terminal_) {
    if (finished_ == total_ || now - drawn_ >= 100ms) draw(now);
  } else if (const std::size_t tenths = finished_ * 10 / total_; tenths > shown_tenths_) {
    shown_tenths_ = tenths;
    draw(now);
  }
}

void Progress::look_within() {
  std::unique_lock lock(mutex_);
  const auto pause = terminal_ ? Clock::duration(between_bars) : Clock::duration(first_plain_line);
  Clock::duration quiet = pause;
  while (!ended_.wait_for(lock, pause, [this] { return over_; })) {
    const auto now = Clock::now();
    if (terminal_) {
      if (now - stepped_ >= patience) draw(now);
    } else if (now - std::max(stepped_, drawn_) >= quiet) {
      quiet *= 2;
      draw(now);
    }
  }
}

void Progress::draw(Clock::time_point now) {
  drawn_ = now;
  const auto within = Steps::at_hand();
  const auto since = [now](Clock::time_point start) {
    return std::chrono::duration<double>(now - start).count();
  };
  if (of_steps_) {
    if (within)
      draw_bar(fmt::format("{}: {}", what_, within->what), within->done, within->total,
               time_left(within->done, within->total, since(within->since)), "");
    else if (terminal_)
      draw_on_terminal("\r\033[K{}", what_);
    else
      say("{}, for {}\n", what_, duration(since(start_)));
    return;
  }
  std::string more;
  if (now - stepped_ >= patience && within && now - within->since >= patience)
    more = fmt::format("; {} {}/{}", within->what, within->done, within->total);
  draw_bar(what_, finished_, total_, finished_ < total_ ? left_.seconds(since(start_)) : std::nullopt, more);
}

void Progress::draw_bar(const std::string& of, std::size_t done, std::size_t total,
                        std::optional<double> left_s, const std::string& more) {
  const double fraction = static_cast<double>(done) / static_cast<double>(total);
  const std::string left = left_s && done < total ? ", " + duration(*left_s) + " left" : "";
  if (terminal_) {
    constexpr int width = 30;
    const int full = static_cast<int>(fraction * width);
    draw_on_terminal("\r\033[K{} [{}{}] {}/{}{}{}", of, std::string(full, '#'),
                     std::string(width - full, '.'), done, total, left, more);
  } else {
    say("{} {}/{}{}{}\n", of, done, total, left, more);
  }
}

}  // namespace tubefoot
