// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string_view>

namespace tubefoot {

/// A file that is written piece by piece and is complete when close() returns. Without close(), the
/// destructor removes it. (Use write_file() of checked_file.hpp for results that fit in memory.)
///
/// A failure of the system throws write_error() and removes the file (never a device). Use of the object
/// after a failure or after close() throws std::logic_error.
class StreamedFile {
 public:
  explicit StreamedFile(std::filesystem::path file);
  ~StreamedFile();
  StreamedFile(const StreamedFile&) = delete;
  StreamedFile& operator=(const StreamedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Returns the number of bytes appended up to now.
  std::uint64_t size() const { return size_; }

  void append(std::span<const std::uint8_t> bytes);
  void append(std::string_view text);
  /// Overwrites existing bytes from `offset` on. append() continues at the end.
  void overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes);
  /// Completes the file, after the system has accepted all bytes.
  void close();

 private:
  std::FILE* open_stream() const;
  [[noreturn]] void fail(int cause);
  void discard();

  std::filesystem::path path_;
  std::FILE* stream_ = nullptr;
  std::uint64_t size_ = 0;
};

}  // namespace tubefoot
