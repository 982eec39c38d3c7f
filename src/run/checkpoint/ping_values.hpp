// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

namespace tubefoot {

/// How much a run has to keep.
struct StoreLayout {
  struct Sensor {
    std::size_t pings = 0, cells = 0;  ///< cells of a ping: channels times beams times samples
    std::size_t channels = 1;          ///< each is packed by itself
  };
  /// Sensors that share their transmissions: a ping of all of them is finished as a whole.
  struct Group {
    std::vector<std::size_t> sensors;
    std::size_t pings = 0;
  };
  std::vector<Sensor> sensors;
  std::vector<Group> groups;
  bool with_bounds = false;
  std::size_t units() const;  ///< pings of all groups
};

/// A ping of a group of sensors.
struct PingUnit {
  std::uint64_t group = 0, ping = 0;
};

/// The energies of a ping while it is made, and their bounds: in memory that is taken up again for the next
/// one, since fresh memory costs more than what most pings put into it.
class PingValues {
 public:
  /// Zeros, as a ping of that group has them.
  void clear(const StoreLayout& layout, std::size_t group);
  /// [channel][beam][sample]; empty for a sensor that is not of the group.
  std::span<double> energy(std::size_t sensor) { return block(sensor, 0); }
  std::span<const double> energy(std::size_t sensor) const {
    const Place place = place_of(sensor, 0);
    return std::span(values_).subspan(place.first, place.cells);
  }
  /// Some of its cells. Where no others are written to, no others need be cleared for the next ping.
  std::span<double> energy(std::size_t sensor, std::size_t first, std::size_t count);
  /// Empty without bounds.
  std::span<double> bound(std::size_t sensor) { return block(sensor, 1); }
  std::span<const double> bound(std::size_t sensor) const {
    const Place place = place_of(sensor, 1);
    return std::span(values_).subspan(place.first, place.cells);
  }

  /// Memory for an echo while it is made: zeros, however many, when it is taken and when it is given back.
  std::vector<double> take_echo_room() { return std::move(echo_room_); }
  void give_back_echo_room(std::vector<double> zeros) { echo_room_ = std::move(zeros); }

 private:
  struct Place {
    std::size_t first = 0, cells = 0;
  };
  std::span<double> block(std::size_t sensor, std::size_t which);
  /// A sensor's bounds follow its energies.
  Place place_of(std::size_t sensor, std::size_t which) const {
    const Place& place = places_.at(sensor);
    return which == 0 || with_bounds_ ? Place{place.first + which * place.cells, place.cells} : Place{};
  }

  std::vector<Place> places_;  ///< by sensor
  std::vector<double> values_;
  bool with_bounds_ = false;
  /// What may have been written to since it was cleared.
  std::vector<Place> written_;
  bool any_written_ = false;  ///< any cell, not those alone
  std::vector<double> echo_room_;
};

/// Values that threads take, make a ping in, and give back. Not one a thread: who waits within a ping for
/// others may begin another.
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
