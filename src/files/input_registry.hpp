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

// The input registry: every byte that is read comes through an InputFile, or, where a library opens the file
// itself, through what checks it first (gdal_input.hpp, hdf5_file.hpp). docs/limits.md says what that
// promises.
namespace tubefoot {

/// An ordinary file, open to be read. Folders, pipes and devices are refused without waiting for anybody at
/// their other end.
class InputFile {
 public:
  /// Throws InputError at `place`, for what is no ordinary file saying that `expected` was.
  InputFile(std::filesystem::path file, const SourcePlace& place,
            std::string_view expected = "a regular file");
  /// Throws InputError at the file itself.
  explicit InputFile(const std::filesystem::path& file);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// For libraries that read by themselves: /proc/self/fd/N is this file, whatever becomes of its name.
  int descriptor() const;
  /// In bytes, when it was opened.
  std::uintmax_t size() const { return size_; }
  /// From its first byte, until it is read.
  std::istream& stream() { return *stream_; }
  /// Its first bytes, at most `most`; the stream is then where it was.
  std::string head(std::size_t most);
  /// What is left of its bytes, in pieces. Throws InputError where reading fails midway.
  void for_each_piece(const std::function<void(std::string_view)>& use);

 private:
  struct Buffer;
  std::filesystem::path path_;
  SourcePlace place_;
  std::uintmax_t size_ = 0;
  std::unique_ptr<Buffer> buffer_;
  std::unique_ptr<std::istream> stream_;
};

/// Which bytes a name stands for, as far as the file system tells: place on the disk, size, time of the last
/// change.
using FileState = std::array<std::int64_t, 5>;
/// Nothing for a name without a file.
std::optional<FileState> state_of(const std::filesystem::path& file);

/// All of a file that has at most `most` bytes. Throws InputError at `place` for a larger one, saying that
/// `expected` is: "a scene file (TOML text)".
std::string read_whole(const std::filesystem::path& file, const SourcePlace& place, std::uintmax_t most,
                       std::string_view expected);

}  // namespace tubefoot
