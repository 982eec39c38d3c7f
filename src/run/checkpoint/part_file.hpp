// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "files/descriptor.hpp"
#include "run/checkpoint/packed_ping.hpp"
#include "run/checkpoint/ping_store.hpp"

namespace tubefoot {

/// File with the pings of one shard of a run. The pings are packed and follow each other in the order in
/// which they finished. If the program is killed, the file keeps all pings except the one that was being
/// written. While the file is open, no other run can open it.
class PartFile {
 public:
  /// Opens and locks the file if it exists. Throws UnusableStore if the file is not a shard, is damaged, or
  /// is in use.
  explicit PartFile(std::filesystem::path file);
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  /// Returns the identity of the run to which the pings belong. The identity is empty if there is no file,
  /// or if the run was killed before it wrote the identity.
  const std::string& identity() const { return identity_; }
  /// Returns whether any bytes follow the identity.
  bool has_pings() const;
  /// Discards the identity, as if the file had none.
  void forget() { identity_.clear(); }
  /// Starts a new file, which replaces any opened file without an identity, or continues an opened file
  /// after its last ping. Throws std::runtime_error naming the file.
  void begin(const std::string& identity);
  /// Finds the pings in the file and checks that each is complete. Before this call, no ping counts as
  /// present.
  void look_through(const StoreLayout& layout);

  bool has(const PingUnit& unit) const { return place(unit).state == State::whole; }
  /// Returns whether the ping is in the file but damaged.
  bool has_damaged(const PingUnit& unit) const { return place(unit).state == State::damaged; }
  std::uint64_t bytes() const { return end_; }

  /// Appends a ping of packed_ping(). Thread-safe. From time to time, flushes the file to the disk. Throws
  /// std::runtime_error naming the file; the pings already in the file stay intact.
  void append(const std::string& packed);
  /// Returns a packed ping of the file. Throws DamagedPing if its bytes have changed.
  std::string read(const PingUnit& unit) const;
  /// Flushes the whole file to the disk. Throws std::runtime_error naming the file.
  void sync() const;
  const std::filesystem::path& path() const { return path_; }

 private:
  enum class State : std::uint8_t { missing, damaged, whole };
  struct Place {
    std::uint64_t offset = 0, bytes = 0;
    State state = State::missing;
  };
  const Place& place(const PingUnit& unit) const { return places_[first_unit_[unit.group] + unit.ping]; }
  void begin_anew(const std::string& identity);
  void write(const std::string& bytes);

  std::filesystem::path path_;
  Descriptor file_;
  std::string identity_;
  std::uint64_t end_ = 0;                ///< offset after the last ping
  std::vector<std::size_t> first_unit_;  ///< by group
  std::vector<Place> places_;            ///< by unit
  std::mutex mutex_;
  std::chrono::steady_clock::time_point next_sync_;
};

}  // namespace tubefoot
