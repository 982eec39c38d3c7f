// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/checkpoint/ping_values.hpp"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <stdexcept>

namespace tubefoot {

const OutputChannel* StoreLayout::Sensor::find(std::string_view channel) const {
  const auto found = std::ranges::find(channels, channel, &OutputChannel::name);
  return found == channels.end() ? nullptr : &*found;
}

double StoreLayout::bytes() const {
  double all = 0;
  for (const Sensor& sensor : sensors)
    for (const OutputChannel& channel : sensor.channels)
      all += static_cast<double>(sensor.pings) * static_cast<double>(channel.values) * sizeof(double);
  return all;
}

std::size_t StoreLayout::units() const {
  std::size_t all = 0;
  for (const Group& group : groups) all += group.pings;
  return all;
}

std::size_t StoreLayout::number_of(const PingUnit& unit) const {
  std::size_t before = 0;
  for (std::size_t group = 0; group < unit.group; ++group) before += groups[group].pings;
  return before + unit.ping;
}

void PingValues::clear(const StoreLayout& layout, std::size_t group) {
  places_.clear();
  std::size_t all = 0;
  for (const std::size_t sensor : layout.groups.at(group).sensors)
    for (const OutputChannel& channel : layout.sensors.at(sensor).channels) {
      places_.push_back({sensor, channel.name, {all, channel.values}});
      all += channel.values;
    }
  if (any_written_ || values_.size() != all) {
    values_.assign(all, 0.0);
  } else {
    for (const Range& range : written_)
      std::fill_n(values_.begin() + std::ptrdiff_t(range.first), range.count, 0.0);
  }
  written_.clear();
  any_written_ = false;
}

const PingValues::Range& PingValues::range_of(std::size_t sensor, std::string_view channel) const {
  for (const Place& place : places_)
    if (place.sensor == sensor && place.channel == channel) return place.range;
  throw std::out_of_range("no output channel " + std::string(channel));
}

std::span<double> PingValues::of(std::size_t sensor, std::string_view channel) {
  const Range& range = range_of(sensor, channel);
  any_written_ = true;
  return std::span(values_).subspan(range.first, range.count);
}

std::span<const double> PingValues::of(std::size_t sensor, std::string_view channel) const {
  const Range& range = range_of(sensor, channel);
  return std::span(values_).subspan(range.first, range.count);
}

std::span<double> PingValues::of(std::size_t sensor, std::string_view channel, std::size_t first,
                                 std::size_t count) {
  const Range& range = range_of(sensor, channel);
  const std::span<double> part = std::span(values_).subspan(range.first, range.count).subspan(first, count);
  constexpr std::size_t most_parts = 1 << 16;
  if (written_.size() == most_parts)
    any_written_ = true;
  else
    written_.push_back({range.first + first, count});
  return part;
}

PingValues PingBufferPool::take() {
  const std::lock_guard lock(mutex_);
  if (spare_.empty()) return {};
  PingValues values = std::move(spare_.back());
  spare_.pop_back();
  return values;
}

void PingBufferPool::give_back(PingValues& values) noexcept {
  try {
    const std::lock_guard lock(mutex_);
    spare_.push_back(std::move(values));
  } catch (const std::exception&) {
    // The next ping then allocates memory again.
  }
}

}  // namespace tubefoot
