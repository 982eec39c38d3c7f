// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string_view>

namespace tubefoot {

/// A file that is written piece by piece and counts as written only when close() has returned; until then it
/// is taken away again on destruction. (write_file of checked_file.hpp is for results that fit in memory.)
///
/// What the system refuses throws write_error(), and the file is taken away at once (never a device); what is
/// asked of it afterwards, or after close(), throws std::logic_error.
class StreamedFile {
 public:
  explicit StreamedFile(std::filesystem::path file);
  ~StreamedFile();
  StreamedFile(const StreamedFile&) = delete;
  StreamedFile& operator=(const StreamedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Bytes appended so far.
  std::uint64_t size() const { return size_; }

  void append(std::span<const std::uint8_t> bytes);
  void append(std::string_view text);
  /// Writes over bytes that are there already, from `offset` on; append() goes on at the end.
  void overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes);
  /// The file is complete, and all of it was taken by the system.
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
