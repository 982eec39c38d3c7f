// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/kept/ping_values.hpp"

#include <exception>

namespace tubefoot {

std::size_t StoreLayout::units() const {
  std::size_t all = 0;
  for (const Group& group : groups) all += group.pings;
  return all;
}

void PingValues::clear(const StoreLayout& layout, std::size_t group) {
  places_.assign(layout.sensors.size(), {});
  with_bounds_ = layout.with_bounds;
  std::size_t all = 0;
  for (const std::size_t sensor : layout.groups.at(group).sensors) {
    places_.at(sensor) = {all, layout.sensors[sensor].cells};
    all += (with_bounds_ ? 2 : 1) * layout.sensors[sensor].cells;
  }
  values_.assign(all, 0.0);
}

PingValues SparePings::take() {
  const std::lock_guard lock(mutex_);
  if (spare_.empty()) return {};
  PingValues values = std::move(spare_.back());
  spare_.pop_back();
  return values;
}

void SparePings::give_back(PingValues& values) noexcept {
  try {
    const std::lock_guard lock(mutex_);
    spare_.push_back(std::move(values));
  } catch (const std::exception&) {
    // Then the next ping takes memory anew.
  }
}

}  // namespace tubefoot
