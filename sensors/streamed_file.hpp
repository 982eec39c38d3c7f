// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>
#include <filesystem>
#include <span>

namespace tubefoot {

/// A file written piece by piece that is complete or not there: one that is not finished, or that a full disk
/// cut short, is taken away (never a device). Errors are std::runtime_error with the file's name and the
/// system's reason; after one, the file is gone and takes nothing more (std::logic_error).
class StreamedFile {
 public:
  /// Creates or empties the file.
  explicit StreamedFile(std::filesystem::path path);
  ~StreamedFile();
  StreamedFile(const StreamedFile&) = delete;
  StreamedFile& operator=(const StreamedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  void write(std::span<const unsigned char> bytes);
  /// Hands everything to the system and closes the file; it stays from here on.
  void finish();

 private:
  void require_open() const;
  /// Closes and takes away what is there; `cause` is an errno.
  [[noreturn]] void fail(int cause);
  void discard();
  void remove_file() const;  // never a device

  std::filesystem::path path_;
  std::FILE* stream_ = nullptr;
};

}  // namespace tubefoot
