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

/// The pings of a part of a run, packed, one behind the other as they were finished. A killed program leaves
/// those before the one that it was writing. While it is open no other run gets it.
class PartFile {
 public:
  /// Takes the file, if there is one. Throws UnusableStore for what is none, is damaged, or is in use.
  explicit PartFile(std::filesystem::path file);
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  /// What the pings belong to; empty: there is no file, or one of a run that was killed as it began.
  const std::string& identity() const { return identity_; }
  /// Whether anything follows the identity.
  bool has_pings() const;
  /// From now on it is as if there were no identity.
  void forget() { identity_.clear(); }
  /// Begins a file, in place of the one that was taken if one was, or goes on with it behind its last ping.
  /// Throws std::runtime_error naming it.
  void begin(const std::string& identity);
  /// Finds the pings that are in it, and looks whether they are whole. Until then there are none.
  void look_through(const StoreLayout& layout);

  bool has(const PingUnit& unit) const { return place(unit).state == State::whole; }
  /// Whether it was there, and is damaged.
  bool has_damaged(const PingUnit& unit) const { return place(unit).state == State::damaged; }
  std::uint64_t bytes() const { return end_; }

  /// Adds a ping of packed_ping(). From any thread. Now and then it brings what is there to the disk. Throws
  /// std::runtime_error naming the file; what was there before stays whole.
  void append(const std::string& packed);
  /// A ping that it has, packed. Throws DamagedPing where it no longer is what it was.
  std::string read(const PingUnit& unit) const;
  /// Brings all of it to the disk. Throws std::runtime_error naming it.
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
  std::uint64_t end_ = 0;                ///< behind the last ping
  std::vector<std::size_t> first_unit_;  ///< by group
  std::vector<Place> places_;            ///< by unit
  std::mutex mutex_;
  std::chrono::steady_clock::time_point next_sync_;
};

}  // namespace tubefoot
