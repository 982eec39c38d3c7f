// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace tubefoot {

/// Bytes that are to stand in a file behind others which are not all known yet, or that are read again: kept
/// in memory while they are few, then in a file without a name beside it, which vanishes with the program,
/// however that ends.
class TemporaryBuffer {
 public:
  /// `beside`: the file that the bytes are for.
  explicit TemporaryBuffer(std::filesystem::path beside) : beside_(std::move(beside)) {}
  ~TemporaryBuffer();
  TemporaryBuffer(TemporaryBuffer&& other) noexcept;
  TemporaryBuffer& operator=(TemporaryBuffer&&) = delete;

  std::uint64_t size() const { return on_disk_ + memory_.size(); }
  /// Throws std::runtime_error with the file's name where the disk refuses; so do the others.
  void add(const void* bytes, std::size_t count);
  template <class Value>
  void put(const Value& value) {
    add(&value, sizeof value);
  }
  /// Bytes from one of them on, while nothing is added: from several threads.
  void read(std::uint64_t first, void* bytes, std::size_t count) const;
  /// All bytes from the beginning, in portions.
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
