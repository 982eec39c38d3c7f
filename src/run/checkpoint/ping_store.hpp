// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "run/checkpoint/packed_ping.hpp"
#include "run/checkpoint/ping_counts.hpp"
#include "run/checkpoint/ping_file.hpp"
#include "run/checkpoint/ping_values.hpp"

// This header declares the store of a run's pings: output channels and counts, in memory or in a checkpoint
// file that survives the program.

namespace tubefoot {

/// The values of a run, by ping, in any order of completion. They lie in memory unpacked, or packed in a
/// file that survives the program. The disk space of all pings is reserved from the start, so that a full
/// disk is detected before any computation. With a file, no ping stays in memory.
class PingStore {
 public:
  /// Creates a store in memory, with all values 0.
  explicit PingStore(const StoreLayout& layout);
  /// Continues a file with its identity, or begins one that has none with this identity. A ping that was
  /// only partly written counts as not done. Throws UnusableStore if the file contains pings of another
  /// layout, and std::runtime_error naming the file and the reason, such as a full disk.
  PingStore(const StoreLayout& layout, std::unique_ptr<PingFile> file, const std::string& identity);
  ~PingStore();
  PingStore(const PingStore&) = delete;
  PingStore& operator=(const PingStore&) = delete;

  bool done(std::size_t group, std::size_t ping) const;
  std::size_t done_units() const;
  /// Stores a ping of a group and marks it as done. Thread-safe. From time to time, flushes finished pings
  /// to the disk, and throws std::runtime_error if that fails.
  void finish(std::size_t group, std::size_t ping, const PingCounts& counts, const PingValues& values);
  /// Stores a ping that another process packed. Throws DamagedPing if the bytes are not a ping of this run.
  void keep(std::string_view packed);
  /// Returns the counts of a finished ping. Throws std::runtime_error if the file has changed.
  PingCounts counts(std::size_t group, std::size_t ping) const;

  bool is_packed() const { return file_ != nullptr; }
  const std::vector<OutputChannel>& channels(std::size_t sensor) const {
    return layout_.sensors.at(sensor).channels;
  }
  /// Returns an output channel of a sensor. Null if the store has no such channel.
  const OutputChannel* find(std::size_t sensor, std::string_view channel) const {
    return layout_.sensors.at(sensor).find(channel);
  }
  /// Returns the values of an output channel for all pings in sequence. Only for a store in memory that has
  /// the channel.
  std::span<const double> in_memory(std::size_t sensor, std::string_view channel) const {
    return block(sensor, channel);
  }
  /// Returns one chunk of an output channel of a ping. The values stay valid while the returned pointer
  /// exists. Thread-safe. Throws std::runtime_error if the file has changed.
  std::shared_ptr<const double> values(std::size_t ping, const ChunkName& name) const;
  /// Returns one chunk as it is packed. Only for a store with a file.
  std::vector<unsigned char> chunk(std::size_t ping, const ChunkName& name) const;
  /// Flushes the whole file to the disk. Throws std::runtime_error naming the file.
  void sync() const {
    if (file_) file_->sync();
  }

 private:
  class Unpacked;
  /// A ping of a store in memory, apart from its values.
  struct Unit {
    std::atomic<bool> done = false;
    PingCounts counts;
  };
  const OutputChannel& channel_of(std::size_t sensor, std::string_view channel) const;
  std::span<double> block(std::size_t sensor, std::string_view channel) const;
  std::span<double> part(std::size_t sensor, std::size_t ping, std::string_view channel) const;
  PackedContents contents(const PingUnit& unit) const;

  StoreLayout layout_;
  std::vector<std::size_t> group_of_;  ///< by sensor
  std::unique_ptr<PingFile> file_;     ///< null for a store in memory
  std::unique_ptr<Unpacked> unpacked_;
  /// for a store in memory, by number of the ping
  std::vector<Unit> units_;
  /// for a store in memory, by sensor and output channel: offset of the values
  std::vector<std::vector<std::size_t>> first_byte_;
  std::size_t bytes_ = 0;
  unsigned char* data_ = nullptr;
};

}  // namespace tubefoot
