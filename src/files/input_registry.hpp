// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <istream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "files/input_error.hpp"

// The input registry. Every byte that tubefoot reads comes through an InputFile. If a library opens a file
// itself, a check precedes it (gdal_input.hpp, hdf5_file.hpp). docs/limits.md states the guarantees.
namespace tubefoot {

/// A regular file that is open for reading. Folders, pipes and devices are rejected without a wait for
/// their other end.
class InputFile {
 public:
  /// Throws InputError at `place`. The message for a file that is not regular states that `expected` was
  /// expected.
  InputFile(std::filesystem::path file, const SourcePlace& place,
            std::string_view expected = "a regular file");
  /// Throws InputError at the file itself.
  explicit InputFile(const std::filesystem::path& file);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Returns the descriptor for libraries that read files themselves: /proc/self/fd/N is this file, even if
  /// its name changes.
  int descriptor() const;
  /// Returns the size in bytes at the time of opening.
  std::uintmax_t size() const { return size_; }
  /// Returns the stream, which begins at the first byte.
  std::istream& stream() { return *stream_; }
  /// Returns the first bytes, at most `most`. The position of the stream does not change.
  std::string head(std::size_t most);
  /// Calls `use` with the remaining bytes, in pieces. Throws InputError if reading fails.
  void for_each_piece(const std::function<void(std::string_view)>& use);

 private:
  struct Buffer;
  std::filesystem::path path_;
  SourcePlace place_;
  std::uintmax_t size_ = 0;
  std::unique_ptr<Buffer> buffer_;
  std::unique_ptr<std::istream> stream_;
};

/// Identity of the bytes under a name, as far as the file system reports it: place on disk, size and time
/// of the last change.
using FileState = std::array<std::int64_t, 5>;
/// Returns the identity of a file; empty if there is no file.
std::optional<FileState> state_of(const std::filesystem::path& file);

/// Returns all bytes of a file that has at most `most`. Throws InputError at `place` for a larger file. The
/// message states that `expected` was expected: "a scene file (TOML text)".
std::string read_whole(const std::filesystem::path& file, const SourcePlace& place, std::uintmax_t most,
                       std::string_view expected);

}  // namespace tubefoot
