// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/checkpoint/ping_values.hpp"

#include <algorithm>
#include <cstddef>
#include <exception>

namespace tubefoot {

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
  places_.assign(layout.sensors.size(), {});
  with_bounds_ = layout.with_bounds;
  std::size_t all = 0;
  for (const std::size_t sensor : layout.groups.at(group).sensors) {
    places_.at(sensor) = {all, layout.sensors[sensor].cells};
    all += (with_bounds_ ? 2 : 1) * layout.sensors[sensor].cells;
  }
  if (any_written_ || values_.size() != all) {
    values_.assign(all, 0.0);
  } else {
    for (const Place& place : written_)
      std::fill_n(values_.begin() + std::ptrdiff_t(place.first), place.cells, 0.0);
  }
  written_.clear();
  any_written_ = false;
}

std::span<double> PingValues::block(std::size_t sensor, std::size_t which) {
  const Place place = place_of(sensor, which);
  any_written_ = any_written_ || place.cells > 0;
  return std::span(values_).subspan(place.first, place.cells);
}

std::span<double> PingValues::energy(std::size_t sensor, std::size_t first, std::size_t count) {
  const Place place = place_of(sensor, 0);
  const std::span<double> part = std::span(values_).subspan(place.first, place.cells).subspan(first, count);
  constexpr std::size_t most_parts = 1 << 16;
  if (written_.size() == most_parts)
    any_written_ = true;
  else
    written_.push_back({place.first + first, count});
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
