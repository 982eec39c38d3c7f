// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sensors/recordings/recorded_channel.hpp"

// This header defines the layout of a run's results by sensor, output channel and ping. It also defines the
// buffers for the values of a ping under computation.

namespace tubefoot {

/// One ping of one group of sensors.
struct PingUnit {
  std::uint64_t group = 0, ping = 0;
};

/// Output channel of a sensor: an array of numbers that a run stores for each ping under this name.
struct OutputChannel {
  std::string name;
  std::size_t values = 0;  ///< number of values per ping
  std::size_t chunks = 1;  ///< number of equal parts of the values, each of which is packed separately
  /// One variable of echoes.nc and Python per chunk. Empty if another writer shows the values.
  std::vector<ChannelVariable> variables{};
};

/// Sizes of everything that a run stores.
struct StoreLayout {
  struct Sensor {
    std::size_t pings = 0;
    std::vector<OutputChannel> channels;
    /// Returns null if the sensor has no such channel.
    const OutputChannel* find(std::string_view channel) const;
  };
  /// Sensors that share their transmissions. A ping of the whole group is finished as one unit.
  struct Group {
    std::vector<std::size_t> sensors;
    std::size_t pings = 0;
  };
  std::vector<Sensor> sensors;
  std::vector<Group> groups;
  /// Returns the number of bytes of all values. It may be larger than any integer.
  double bytes() const;
  std::size_t units() const;  ///< Returns the number of pings of all groups.
  /// Returns the number of pings that precede this ping: those of earlier groups, and of its own group.
  std::size_t number_of(const PingUnit& unit) const;
};

/// Values of one ping while it is computed. The memory is reused for the next ping, because new memory costs
/// more time than most pings need to fill it.
class PingValues {
 public:
  /// Sets all values to zero, in the layout of a ping of that group.
  void clear(const StoreLayout& layout, std::size_t group);
  /// Returns the values of an output channel. Throws std::out_of_range if pings of this group have no such
  /// channel, as the functions below do.
  std::span<double> of(std::size_t sensor, std::string_view channel);
  std::span<const double> of(std::size_t sensor, std::string_view channel) const;
  /// Returns some of the channel's values. If a caller writes only to such ranges, only these are cleared for
  /// the next ping.
  std::span<double> of(std::size_t sensor, std::string_view channel, std::size_t first, std::size_t count);

  /// Hands out a buffer for an echo under computation. All its values are zero, whatever their number, when
  /// the caller takes it and when the caller returns it.
  std::vector<double> take_echo_room() { return std::move(echo_room_); }
  void give_back_echo_room(std::vector<double> zeros) { echo_room_ = std::move(zeros); }

 private:
  struct Range {
    std::size_t first = 0, count = 0;
  };
  struct Place {
    std::size_t sensor = 0;
    std::string channel;
    Range range;
  };
  const Range& range_of(std::size_t sensor, std::string_view channel) const;

  std::vector<Place> places_;  ///< in the order of the group's sensors and of their channels
  std::vector<double> values_;
  /// Ranges that a caller may have written to since the last clear().
  std::vector<Range> written_;
  bool any_written_ = false;  ///< true if a caller may have written to any value
  std::vector<double> echo_room_;
};

/// Pool of buffers: a thread takes one, computes a ping in it, and returns it. There is no fixed buffer per
/// thread, because a thread that waits within one ping may start another ping.
class PingBufferPool {
 public:
  template <class Use>
  auto with(const Use& use) {
    Lent lent{*this, take()};
    return use(lent.values);
  }

 private:
  struct Lent {
    PingBufferPool& of;
    PingValues values;
    ~Lent() { of.give_back(values); }
  };
  PingValues take();
  void give_back(PingValues& values) noexcept;

  std::mutex mutex_;
  std::vector<PingValues> spare_;
};

}  // namespace tubefoot
