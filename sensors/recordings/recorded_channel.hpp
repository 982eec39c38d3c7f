// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sensors/recordings/ping_energies.hpp"

namespace tubefoot {

/// Name and meaning of an array over ping, beam and range bin, as echoes.nc and Python show them.
struct ChannelVariable {
  std::string name, units, long_name;
  bool has_coordinates = false;  ///< whether echoes.nc refers to its coordinates
  bool is_by_beam = false;       ///< if true, the array is over ping and beam
};

/// Returns the variables of a sensor's energies, or of their certified bounds. A receiver pair has four
/// channels: the energies of both receivers, and the parts of their mean product.
std::vector<ChannelVariable> energy_variables(std::size_t channels, bool bounds);

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

/// The values of one variable: an equal part of each ping of a channel.
struct RecordedVariable {
  ChannelVariable meaning;
  RecordedChannel channel;
  std::size_t part = 0, parts = 1, cells = 0;  ///< number of the part; parts per ping; values per part

  PingEnergies of(std::size_t ping) const {
    return channel.packed ? channel.packed->values(ping, part)
                          : PingEnergies(channel.values.subspan((ping * parts + part) * cells, cells));
  }
};

}  // namespace tubefoot
