// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "files/input_registry.hpp"

namespace tubefoot {

/// Random access to the bytes of a file, or of memory into which a file was decompressed.
class ByteSource {
 public:
  explicit ByteSource(const std::filesystem::path& file);
  /// `file` is the origin of the bytes.
  ByteSource(const std::filesystem::path& file, std::vector<std::uint8_t> bytes);

  const SourcePlace& place() const { return place_; }
  std::uint64_t size() const { return file_ ? file_->size() : memory_.size(); }
  /// Fills `bytes`, starting at offset `at`. Throws InputError if the file is too short or cannot be read.
  void read(std::uint64_t at, std::span<std::uint8_t> bytes);
  std::vector<std::uint8_t> read(std::uint64_t at, std::uint64_t count);

 private:
  SourcePlace place_;
  std::unique_ptr<InputFile> file_;
  std::vector<std::uint8_t> memory_;
};

}  // namespace tubefoot
