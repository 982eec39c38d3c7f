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

namespace tubefoot {

/// A file of pings that cannot be gone on with.
struct UnusableStore : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// One that another run has.
struct StoreInUse : UnusableStore {
  explicit StoreInUse(const std::filesystem::path& file);
};

/// Opens a file of pings, or makes it where there must be none yet, so that no other run gets it while it is
/// open. No descriptor if there is none and none is made. Throws UnusableStore for what is not a run's own
/// file (a link, a file with a second name or of somebody else), and std::runtime_error naming the file.
Descriptor take_ping_file(const std::filesystem::path& file, bool make);

/// The energies of a run, ping by ping in any order: in memory as they are, or packed in a file that survives
/// the program. The file is as large as it will ever be from the start, so that a full disk is met before
/// anything is computed; packed pings lie in it one behind the other, so that the disk has little to write,
/// and nothing of them stays in memory.
class PingStore {
 public:
  /// Zeroed, in memory.
  explicit PingStore(const StoreLayout& layout);
  /// A new file in place of any that is there. `identity` says what the pings belong to. Throws
  /// std::runtime_error naming the file and the reason, such as a full disk.
  PingStore(const StoreLayout& layout, const std::filesystem::path& file, const std::string& identity);
  /// The same in a file that was taken.
  PingStore(const StoreLayout& layout, const std::filesystem::path& file, Descriptor taken,
            const std::string& identity);
  /// Goes on with a file. Pings that were cut off while they were written count as not done. Throws
  /// UnusableStore for a file of another layout, one that is cut short, in use, or no such file at all.
  static std::unique_ptr<PingStore> reopen(const StoreLayout& layout, const std::filesystem::path& file);
  static std::unique_ptr<PingStore> reopen(const StoreLayout& layout, const std::filesystem::path& file,
                                           Descriptor taken);
  ~PingStore();
  PingStore(const PingStore&) = delete;
  PingStore& operator=(const PingStore&) = delete;

  bool done(std::size_t group, std::size_t ping) const { return unit(group, ping).checksum != 0; }
  std::size_t done_units() const;
  /// Keeps a ping of a group, which is done with that. From several threads. Now and then it brings what is
  /// done to the disk: throws std::runtime_error where that fails.
  void finish(std::size_t group, std::size_t ping, const PingCounts& counts, const PingValues& values);
  /// The same of a ping that another process packed. Throws DamagedPing for what is none of this run.
  void keep(std::string_view packed);
  const PingCounts& counts(std::size_t group, std::size_t ping) const { return unit(group, ping).counts; }

  bool is_packed() const { return static_cast<bool>(file_); }
  bool has_bounds() const { return layout_.with_bounds; }
  /// Values of a channel.
  std::size_t values_a_chunk(std::size_t sensor) const {
    return layout_.sensors.at(sensor).cells / layout_.sensors[sensor].channels;
  }
  /// In memory: [ping][channel][beam][sample].
  std::span<const double> energy(std::size_t sensor) const { return block(sensor, 0); }
  /// Empty without bounds.
  std::span<const double> bound(std::size_t sensor) const { return block(sensor, 1); }
  /// The values of a channel of a ping, [beam][sample], for as long as somebody has them. From several
  /// threads. Throws std::runtime_error where the file no longer has what it had.
  std::shared_ptr<const double> values(std::size_t ping, const ChunkName& name) const;
  /// Of a file: the same as they are packed.
  std::vector<unsigned char> chunk(std::size_t ping, const ChunkName& name) const;
  /// Brings all of a file to the disk. Throws std::runtime_error naming it.
  void sync() const;

 private:
  struct Unit {
    std::uint64_t checksum = 0;          ///< 0: not done
    std::uint64_t first = 0, bytes = 0;  ///< of a file: where the packed ping lies
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
  std::filesystem::path path_;           ///< empty: in memory
  std::size_t first_unit_byte_ = 0;      ///< after the header
  std::vector<std::size_t> first_unit_;  ///< by group
  std::vector<std::size_t> group_of_;    ///< by sensor
  std::vector<std::size_t> first_byte_;  ///< in memory, by sensor: of its energies; its bounds follow
  std::size_t bytes_ = 0;                ///< of all of it
  std::size_t mapped_bytes_ = 0;         ///< of a file: up to the first packed ping
  std::atomic<std::uint64_t> end_ = 0;   ///< of a file: of the packed pings
  unsigned char* data_ = nullptr;
  Descriptor file_;
  std::unique_ptr<Unpacked> unpacked_;
  std::atomic<std::chrono::steady_clock::time_point> next_sync_;
};

/// What a file of pings says of itself, without going on with it.
struct StoreSummary {
  std::string identity;
  std::size_t units = 0, done = 0;
  bool in_use = false;  ///< another process writes to it
};
/// Throws UnusableStore.
StoreSummary summary_of(const std::filesystem::path& file);
StoreSummary summary_of(const std::filesystem::path& name, const Descriptor& file);

}  // namespace tubefoot
