// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "sensors/recordings/ping_energies.hpp"

namespace tubefoot {

/// Values of an output channel of a recording. They are stored elsewhere, in memory or packed.
struct RecordedChannel {
  std::span<const double> values{};             ///< of all pings in sequence; empty if they are packed
  std::shared_ptr<const PackedPings> packed{};  ///< in place of `values`
  std::shared_ptr<const void> keeper{};         ///< owner of the values; null if another object owns them

  bool is_empty() const { return values.empty() && !packed; }
  /// Returns the values of a ping of a channel with `count` values per ping, all in one chunk.
  PingEnergies of(std::size_t ping, std::size_t count) const {
    return packed ? packed->values(ping, 0) : PingEnergies(values.subspan(ping * count, count));
  }
};

}  // namespace tubefoot
