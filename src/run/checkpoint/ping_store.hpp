// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "files/descriptor.hpp"
#include "run/checkpoint/packed_ping.hpp"
#include "run/checkpoint/ping_counts.hpp"
#include "run/checkpoint/ping_values.hpp"

// This header declares the store of a run's pings: energies, bounds and counts, in memory or in a checkpoint
// file that survives the program.

namespace tubefoot {

/// Error for a file of pings that a run cannot continue.
struct UnusableStore : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// Error for a file of pings that another run has open.
struct StoreInUse : UnusableStore {
  explicit StoreInUse(const std::filesystem::path& file);
};

/// Opens and locks a file of pings, so that no other run can open it. With `make`, creates the file, which
/// must not exist yet. Without `make`, returns an empty descriptor if there is no file. Throws UnusableStore
/// if the file is not the run's own: a link, a file with a second name, or a file of another user. Throws
/// std::runtime_error naming the file.
Descriptor take_ping_file(const std::filesystem::path& file, bool make);

/// The energies of a run, by ping, in any order of completion. They lie in memory unpacked, or packed in a
/// file that survives the program. The file has its final size from the start, so that a full disk is
/// detected before any computation. Packed pings follow each other in the file, so that little is written.
/// With a file, no ping stays in memory.
class PingStore {
 public:
  /// Creates a store in memory, with all values 0.
  explicit PingStore(const StoreLayout& layout);
  /// Creates a new file, which replaces any existing one. `identity` describes the run to which the pings
  /// belong. Throws std::runtime_error naming the file and the reason, such as a full disk.
  PingStore(const StoreLayout& layout, const std::filesystem::path& file, const std::string& identity);
  /// Creates the store in a file that take_ping_file() opened.
  PingStore(const StoreLayout& layout, const std::filesystem::path& file, Descriptor taken,
            const std::string& identity);
  /// Continues a file. A ping that was only partly written counts as not done. Throws UnusableStore if the
  /// file has another layout, is truncated, is in use, or is not a file of pings.
  static std::unique_ptr<PingStore> reopen(const StoreLayout& layout, const std::filesystem::path& file);
  static std::unique_ptr<PingStore> reopen(const StoreLayout& layout, const std::filesystem::path& file,
                                           Descriptor taken);
  ~PingStore();
  PingStore(const PingStore&) = delete;
  PingStore& operator=(const PingStore&) = delete;

  bool done(std::size_t group, std::size_t ping) const { return unit(group, ping).checksum != 0; }
  std::size_t done_units() const;
  /// Stores a ping of a group and marks it as done. Thread-safe. From time to time, flushes finished pings
  /// to the disk, and throws std::runtime_error if that fails.
  void finish(std::size_t group, std::size_t ping, const PingCounts& counts, const PingValues& values);
  /// Stores a ping that another process packed. Throws DamagedPing if the bytes are not a ping of this run.
  void keep(std::string_view packed);
  const PingCounts& counts(std::size_t group, std::size_t ping) const { return unit(group, ping).counts; }

  bool is_packed() const { return static_cast<bool>(file_); }
  bool has_bounds() const { return layout_.with_bounds; }
  /// Returns the number of values of one channel.
  std::size_t values_a_chunk(std::size_t sensor) const {
    return layout_.sensors.at(sensor).cells / layout_.sensors[sensor].channels;
  }
  /// Returns the energies of a store in memory: [ping][channel][beam][sample].
  std::span<const double> energy(std::size_t sensor) const { return block(sensor, 0); }
  /// Returns the bounds of a store in memory. Empty if the store has no bounds.
  std::span<const double> bound(std::size_t sensor) const { return block(sensor, 1); }
  /// Returns the values of one channel of a ping, [beam][sample]. They stay valid while the returned pointer
  /// exists. Thread-safe. Throws std::runtime_error if the file has changed.
  std::shared_ptr<const double> values(std::size_t ping, const ChunkName& name) const;
  /// Returns the packed values of one channel of a ping. Only for a store with a file.
  std::vector<unsigned char> chunk(std::size_t ping, const ChunkName& name) const;
  /// Flushes the whole file to the disk. Throws std::runtime_error naming the file.
  void sync() const;

 private:
  struct Unit {
    std::uint64_t checksum = 0;          ///< 0: not done
    std::uint64_t first = 0, bytes = 0;  ///< for a file: position of the packed ping
    PingCounts counts;
  };
  class Unpacked;
  void map();
  void look_through();
  Unit& unit(std::size_t group, std::size_t ping) const;
  void mark_done(const PingUnit& at, std::uint64_t first, std::uint64_t bytes, const PingCounts& counts);
  std::span<double> block(std::size_t sensor, int which) const;
  std::span<double> part(std::size_t sensor, std::size_t ping, int which) const;
  void read(std::uint64_t first, void* bytes, std::size_t count) const;
  void write(std::uint64_t first, std::string_view bytes) const;

  explicit PingStore(const StoreLayout& layout, std::filesystem::path path, std::size_t identity_bytes);

  StoreLayout layout_;
  std::filesystem::path path_;           ///< empty for a store in memory
  std::size_t first_unit_byte_ = 0;      ///< offset after the header and the identity
  std::vector<std::size_t> first_unit_;  ///< by group
  std::vector<std::size_t> group_of_;    ///< by sensor
  /// for a store in memory, by sensor: offset of its energies, which its bounds follow
  std::vector<std::size_t> first_byte_;
  std::size_t bytes_ = 0;               ///< size of the whole store
  std::size_t mapped_bytes_ = 0;        ///< for a file: bytes before the first packed ping
  std::atomic<std::uint64_t> end_ = 0;  ///< for a file: offset after the last packed ping
  unsigned char* data_ = nullptr;
  Descriptor file_;
  std::unique_ptr<Unpacked> unpacked_;
  std::atomic<std::chrono::steady_clock::time_point> next_sync_;
};

/// Summary of a file of pings, which is read without continuing the file.
struct StoreSummary {
  std::string identity;
  std::size_t units = 0, done = 0;
  bool in_use = false;  ///< true while another process writes to the file
};
/// Reads the summary of a file of pings. Throws UnusableStore.
StoreSummary summary_of(const std::filesystem::path& file);
StoreSummary summary_of(const std::filesystem::path& name, const Descriptor& file);

}  // namespace tubefoot
