// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace tubefoot {

/// A buffer for bytes that follow others in a file before those are known, or that are read again. Few
/// bytes stay in memory. More bytes are in a nameless file in the folder of the output, which vanishes with
/// the program in any case.
class TemporaryBuffer {
 public:
  /// `beside` is the file that will contain the bytes.
  explicit TemporaryBuffer(std::filesystem::path beside) : beside_(std::move(beside)) {}
  ~TemporaryBuffer();
  TemporaryBuffer(TemporaryBuffer&& other) noexcept;
  TemporaryBuffer& operator=(TemporaryBuffer&&) = delete;

  std::uint64_t size() const { return on_disk_ + memory_.size(); }
  /// Throws std::runtime_error with the name of the file if the disk fails, as do the other members.
  void add(const void* bytes, std::size_t count);
  template <class Value>
  void put(const Value& value) {
    add(&value, sizeof value);
  }
  /// Reads bytes from position `first` on. Several threads may read while no thread adds bytes.
  void read(std::uint64_t first, void* bytes, std::size_t count) const;
  /// Calls `take` with all bytes from the beginning, in portions.
  void replay(const std::function<void(std::span<const char>)>& take);

 private:
  void flush();
  [[noreturn]] void fail() const;

  std::filesystem::path beside_;
  std::string memory_;
  std::FILE* file_ = nullptr;
  std::uint64_t on_disk_ = 0;
};

}  // namespace tubefoot
