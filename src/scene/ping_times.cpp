// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/ping_times.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace tubefoot {

PingTimes::PingTimes(const SensorDescription& sensor, const Trajectory& trajectory,
                     const std::string& trajectory_name)
    : listed_s_(sensor.ping_times_s),
      interval_s_(sensor.ping_interval_s),
      divided_(!trajectory.lines().empty()) {
  const auto refuse = [&](const std::string& what) { throw InputError(sensor.place, what); };
  const bool listed = !listed_s_.empty();
  if (divided_ && listed)
    refuse(
        fmt::format("sensor '{}' has 'ping_times_s', but trajectory '{}' is divided into lines: give "
                    "'first_ping_s' and 'ping_interval_s', which apply to each line",
                    sensor.name, trajectory_name));
  if (!divided_) {
    count_ = listed ? listed_s_.size() : static_cast<std::size_t>(sensor.pings.value_or(1));
    starts_ = {0};
    first_s_ = {listed ? listed_s_.front() : sensor.first_ping_s};
    if (trajectory.is_fixed()) return;
    const double last_s =
        listed ? listed_s_.back() : first_s_[0] + static_cast<double>(count_ - 1) * interval_s_;
    for (const auto& [ping, time_s] : {std::pair(std::size_t{0}, first_s_[0]), std::pair(count_ - 1, last_s)})
      if (!trajectory.holds(time_s))
        refuse(fmt::format(
            "ping {} of sensor '{}' is at {:.9g} s, outside of its trajectory '{}', which lasts from {:.9g} "
            "s to "
            "{:.9g} s: change {}, or the trajectory",
            ping, sensor.name, time_s, trajectory_name, trajectory.begin_s(), trajectory.end_s(),
            listed ? "ping_times_s" : "first_ping_s, pings or ping_interval_s"));
    return;
  }
  constexpr double most = 1e7, rounding = 1e-9;
  double held = 0;
  for (const Trajectory::Line& line : trajectory.lines()) {
    const double of_line =
        std::floor((line.end_s - line.begin_s - sensor.first_ping_s) / interval_s_ + rounding) + 1;
    if (sensor.first_ping_s < 0 || !(of_line >= 1)) continue;
    if (sensor.pings && held >= *sensor.pings) break;
    starts_.push_back(static_cast<std::size_t>(held));
    first_s_.push_back(line.begin_s + sensor.first_ping_s);
    held += of_line;
    if (!sensor.pings && held > most)
      refuse(
          fmt::format("the lines of trajectory '{}' hold more than {:g} pings of sensor '{}': increase "
                      "'ping_interval_s', or reduce 'pings'",
                      trajectory_name, most, sensor.name));
  }
  if (starts_.empty())
    refuse(
        fmt::format("no ping of sensor '{}' is on a line of trajectory '{}': change 'first_ping_s', which is "
                    "relative to the start of each line",
                    sensor.name, trajectory_name));
  if (sensor.pings && *sensor.pings > held)
    refuse(fmt::format(
        "sensor '{}' is set to {} pings, but the lines of trajectory '{}' hold only {:.0f}: reduce 'pings' "
        "(without this key, all are simulated), or change 'ping_interval_s' or the lines",
        sensor.name, *sensor.pings, trajectory_name, held));
  count_ = static_cast<std::size_t>(sensor.pings ? static_cast<double>(*sensor.pings) : held);
}

std::vector<double> PingTimes::times_s() const {
  std::vector<double> times;
  times.reserve(count_);
  each([&](double time_s) { times.push_back(time_s); });
  return times;
}

}  // namespace tubefoot
