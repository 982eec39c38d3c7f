// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "app/say.hpp"

namespace tubefoot {
namespace {

std::string duration(double seconds) {
  if (seconds < 1) return "under 1 s";
  if (seconds < 60) return fmt::format("{:.0f} s", seconds);
  const auto whole = static_cast<long>(seconds + 0.5);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace

Progress::Progress(std::string what, std::size_t total, bool quiet)
    : what_(std::move(what)),
      total_(total),
      quiet_(quiet || total == 0),
      terminal_(isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()),
      drawn_(start_) {
  if (!quiet_ && terminal_) draw(0, 0);
}

Progress::~Progress() {
  if (!quiet_ && terminal_) say("\r\033[K");
}

void Progress::step() {
  const std::lock_guard lock(mutex_);
  ++finished_;
  if (quiet_) return;
  const auto now = std::chrono::steady_clock::now();
  const double seconds = std::chrono::duration<double>(now - start_).count();
  if (terminal_) {
    if (finished_ < total_ && now - drawn_ < std::chrono::milliseconds(100)) return;
    drawn_ = now;
    draw(finished_, seconds);
  } else if (const std::size_t tenths = finished_ * 10 / total_; tenths > shown_tenths_) {
    shown_tenths_ = tenths;
    draw(finished_, seconds);
  }
}

void Progress::draw(std::size_t finished, double seconds) const {
  const double fraction = static_cast<double>(finished) / static_cast<double>(total_);
  std::string left;
  if (finished > 0 && finished < total_)
    left = ", " + duration(seconds * (1 - fraction) / fraction) + " left";
  if (terminal_) {
    constexpr int width = 30;
    const int full = static_cast<int>(fraction * width);
    say("\r\033[K{} [{}{}] {}/{}{}", what_, std::string(full, '#'), std::string(width - full, '.'), finished,
        total_, left);
    std::fflush(stderr);
  } else {
    say("{} {}/{}{}\n", what_, finished, total_, left);
  }
}

}  // namespace tubefoot
