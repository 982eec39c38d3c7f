// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace tubefoot {

/// All pings of all groups in one order. The order alternates between stretches of the groups, so that at
/// any time about the same share of each group is done. The number of finished pings then indicates the
/// remaining time, even if the pings of one group take much longer than those of another.
class PingOrder {
 public:
  explicit PingOrder(std::span<const std::size_t> pings_of_groups)
      : pings_(pings_of_groups.begin(), pings_of_groups.end()) {
    begins_.push_back(0);
    for (std::size_t stretch = 0; stretch < stretches; ++stretch)
      for (const std::size_t pings : pings_)
        begins_.push_back(begins_.back() + cut(pings, stretch + 1) - cut(pings, stretch));
  }

  std::size_t size() const { return begins_.back(); }
  /// Returns group and ping.
  std::pair<std::size_t, std::size_t> operator[](std::size_t place) const {
    const auto piece =
        static_cast<std::size_t>(std::ranges::upper_bound(begins_, place) - begins_.begin() - 1);
    const std::size_t group = piece % pings_.size();
    return {group, cut(pings_[group], piece / pings_.size()) + place - begins_[piece]};
  }

 private:
  static constexpr std::size_t stretches = 32;
  static std::size_t cut(std::size_t pings, std::size_t stretch) {
    return pings / stretches * stretch + pings % stretches * stretch / stretches;
  }

  std::vector<std::size_t> pings_, begins_;
};

}  // namespace tubefoot
