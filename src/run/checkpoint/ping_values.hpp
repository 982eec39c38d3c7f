// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

// This header defines the layout of a run's results by sensor and ping. It also defines the buffers for the
// energies and bounds of a ping under computation.

namespace tubefoot {

/// One ping of one group of sensors.
struct PingUnit {
  std::uint64_t group = 0, ping = 0;
};

/// Sizes of everything that a run stores.
struct StoreLayout {
  struct Sensor {
    std::size_t pings = 0, cells = 0;  ///< number of values per ping: channels times beams times samples
    std::size_t channels = 1;          ///< number of channels, each of which is packed separately
  };
  /// Sensors that share their transmissions. A ping of the whole group is finished as one unit.
  struct Group {
    std::vector<std::size_t> sensors;
    std::size_t pings = 0;
  };
  std::vector<Sensor> sensors;
  std::vector<Group> groups;
  bool with_bounds = false;
  std::size_t units() const;  ///< Returns the number of pings of all groups.
  /// Returns the number of pings that precede this ping: those of earlier groups, and of its own group.
  std::size_t number_of(const PingUnit& unit) const;
};

/// Energies and bounds of one ping while it is computed. The memory is reused for the next ping, because new
/// memory costs more time than most pings need to fill it.
class PingValues {
 public:
  /// Sets all values to zero, in the layout of a ping of that group.
  void clear(const StoreLayout& layout, std::size_t group);
  /// Returns the energies [channel][beam][sample]. Empty for a sensor outside of the group.
  std::span<double> energy(std::size_t sensor) { return block(sensor, 0); }
  std::span<const double> energy(std::size_t sensor) const {
    const Place place = place_of(sensor, 0);
    return std::span(values_).subspan(place.first, place.cells);
  }
  /// Returns some of the sensor's values. If a caller writes only to such ranges, only these are cleared for
  /// the next ping.
  std::span<double> energy(std::size_t sensor, std::size_t first, std::size_t count);
  /// Returns the bounds. Empty if the layout has no bounds.
  std::span<double> bound(std::size_t sensor) { return block(sensor, 1); }
  std::span<const double> bound(std::size_t sensor) const {
    const Place place = place_of(sensor, 1);
    return std::span(values_).subspan(place.first, place.cells);
  }

  /// Hands out a buffer for an echo under computation. All its values are zero, whatever their number, when
  /// the caller takes it and when the caller returns it.
  std::vector<double> take_echo_room() { return std::move(echo_room_); }
  void give_back_echo_room(std::vector<double> zeros) { echo_room_ = std::move(zeros); }

 private:
  struct Place {
    std::size_t first = 0, cells = 0;
  };
  std::span<double> block(std::size_t sensor, std::size_t which);
  /// The bounds of a sensor follow its energies.
  Place place_of(std::size_t sensor, std::size_t which) const {
    const Place& place = places_.at(sensor);
    return which == 0 || with_bounds_ ? Place{place.first + which * place.cells, place.cells} : Place{};
  }

  std::vector<Place> places_;  ///< by sensor
  std::vector<double> values_;
  bool with_bounds_ = false;
  /// Ranges that a caller may have written to since the last clear().
  std::vector<Place> written_;
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
