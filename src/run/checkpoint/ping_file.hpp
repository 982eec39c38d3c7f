// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "files/descriptor.hpp"
#include "run/checkpoint/packed_ping.hpp"

namespace tubefoot {

/// Error for a file of pings that a run cannot continue.
struct UnusableStore : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// Error for a file of pings that another run has open.
struct StoreInUse : UnusableStore {
  explicit StoreInUse(const std::filesystem::path& file);
};

/// File of packed pings: the checkpoint of a run, or one shard. The pings follow each other in the order in
/// which they finished. If the program is killed, the file keeps all pings except the one that was being
/// written. While the file is open, no other run can open it.
class PingFile {
 public:
  /// Opens and locks the file if it exists. `kind`: "checkpoint" or "shard", for messages. Throws
  /// UnusableStore if the file is not the run's own: a link, a file with a second name, or a file of another
  /// user. Also throws UnusableStore if the file is of another format, is damaged, or is in use.
  explicit PingFile(std::filesystem::path file, std::string kind = "checkpoint");
  PingFile(const PingFile&) = delete;
  PingFile& operator=(const PingFile&) = delete;

  /// Returns the identity of the run to which the pings belong. The identity is empty if there is no file,
  /// or if the run was killed before it wrote the identity.
  const std::string& identity() const { return identity_; }
  /// Returns the number of different pings of which the file contains a complete record. The values of a
  /// record may still be damaged.
  std::size_t pings() const;
  /// Discards the identity, as if the file had none.
  void forget() { identity_.clear(); }
  /// Finds the pings in the file and checks that each is complete. Before this call, no ping counts as
  /// present. Throws UnusableStore if the file contains pings of another layout.
  void look_through(const StoreLayout& layout);
  /// Starts a new file, which replaces any opened file without an identity, or continues an opened file
  /// after its last ping. With `reserved_bytes`, the file can grow by this size even if other programs fill
  /// the disk. Throws std::runtime_error naming the file; a file that this call created is then removed.
  void begin(const std::string& identity, std::uint64_t reserved_bytes = 0);

  bool has(const PingUnit& unit) const { return place(unit).load(std::memory_order_acquire) != missing; }
  /// Returns whether the ping is absent although the file contains damaged bytes, which may be this ping.
  bool may_have_damaged(const PingUnit& unit) const;
  std::uint64_t bytes() const { return end_; }

  /// Appends a ping of packed_ping(). Thread-safe. From time to time, flushes the file to the disk. Throws
  /// std::runtime_error naming the file; the pings already in the file stay intact.
  void append(std::string_view packed);
  /// Returns a packed ping. Throws DamagedPing if its bytes have changed.
  std::string read(const PingUnit& unit) const;
  /// Returns some bytes of a packed ping. Throws DamagedPing if the file is too short.
  std::string read(const PingUnit& unit, std::size_t first, std::size_t count) const;
  /// Flushes the whole file to the disk. Throws std::runtime_error naming the file.
  void sync() const;
  const std::filesystem::path& path() const { return path_; }

 private:
  friend struct StoreSummary summary_of(const std::filesystem::path& file);
  using Place = std::atomic<std::uint64_t>;  ///< offset of a packed ping
  static constexpr std::uint64_t missing = 0;

  PingFile(std::filesystem::path file, std::string kind, Descriptor opened);
  const Place& place(const PingUnit& unit) const { return places_.at(layout_.number_of(unit)); }
  /// Calls `visit` with the offset and the header of each record. Returns the offset after the last record.
  std::uint64_t each_record(const std::function<void(std::uint64_t, const PackedHead&)>& visit,
                            bool& unreadable) const;
  void begin_anew(const std::string& identity);
  void reserve(std::uint64_t bytes) const;
  void write(std::string_view bytes);
  [[noreturn]] void fail(const std::string& task, int error) const;

  std::filesystem::path path_;
  std::string kind_;
  Descriptor file_;
  std::string identity_;
  std::uint64_t first_record_ = 0;  ///< offset after the identity
  std::uint64_t end_ = 0;           ///< offset after the last ping
  StoreLayout layout_;
  std::vector<Place> places_;  ///< by number of the ping in the layout
  std::vector<bool> damaged_;  ///< by number of the ping
  bool unreadable_ = false;    ///< true if the file contains bytes that are not a record
  std::mutex mutex_;
  std::chrono::steady_clock::time_point next_sync_;
};

/// Summary of a file of pings, which may be in use.
struct StoreSummary {
  std::string identity;
  std::size_t done = 0;
  bool in_use = false;  ///< true while another process writes to the file
};
/// Reads the summary of a file of pings. Throws UnusableStore.
StoreSummary summary_of(const std::filesystem::path& file);

}  // namespace tubefoot
