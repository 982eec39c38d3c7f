// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/console/time_left.hpp"

#include <algorithm>

namespace tubefoot {
namespace {

constexpr std::size_t fewest_steps = 2, parts = 10;

bool enough(std::size_t done, std::size_t total) {
  return done >= fewest_steps && done >= (total + parts - 1) / parts;
}

}  // namespace

void TimeLeft::step(double at_s) {
  constexpr std::size_t most_times = 1024;
  ++done_;
  last_s_ = at_s;
  if (done_ == 1) first_s_ = at_s;
  if (done_ % stride_ != 0) return;
  times_.emplace_back(done_, at_s);
  if (times_.size() < most_times) return;
  stride_ *= 2;
  std::erase_if(times_, [this](const auto& time) { return time.first % stride_ != 0; });
}

std::optional<double> TimeLeft::seconds(double now_s) const {
  if (!enough(done_, total_) || done_ > total_) return std::nullopt;
  const auto after_half =
      std::ranges::upper_bound(times_, done_ / 2, {}, [](const auto& time) { return time.first; });
  const auto [half, half_s] =
      after_half == times_.begin() ? std::pair<std::size_t, double>{0, 0.0} : *std::prev(after_half);
  if (done_ - half < 2 * threads_ && last_s_ - half_s < first_s_) return std::nullopt;
  const double a_step_s = (last_s_ - half_s) / static_cast<double>(done_ - half);
  // The next step has been in progress since the end of the last one.
  const double under_way_s = std::min(now_s - last_s_, a_step_s);
  return std::max(0.0, a_step_s * static_cast<double>(total_ - done_) - under_way_s) + afterwards_s_;
}

std::optional<double> time_left(std::size_t done, std::size_t total, double seconds) {
  if (!enough(done, total) || done > total) return std::nullopt;
  return seconds * static_cast<double>(total - done) / static_cast<double>(done);
}

}  // namespace tubefoot
