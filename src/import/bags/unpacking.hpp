// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/input_error.hpp"

namespace tubefoot {

/// Total decompressed size of the compressed parts of one recording. It stops a recording of a few
/// megabytes that decompresses to terabytes early.
class UnpackedBytes {
 public:
  /// `packed`: size of all files of the recording.
  explicit UnpackedBytes(std::uint64_t packed);
  /// Throws InputError at `place` ("`what`: ...") if `bytes` more exceed the limit.
  void add(std::uint64_t bytes, const SourcePlace& place, const std::string& what);
  std::uint64_t left() const { return most_ - taken_; }

 private:
  std::uint64_t most_, taken_ = 0;
};

bool is_zstd(std::span<const std::uint8_t> bytes);

/// Decompresses zstd frames to at most `most` bytes. Throws InputError at `place` ("`what`: ...") for
/// damaged data. It also throws, before it decompresses further, if the output exceeds `most` or the
/// available memory.
std::vector<std::uint8_t> unpack_zstd(std::span<const std::uint8_t> packed, std::uint64_t most,
                                      const SourcePlace& place, const std::string& what);

/// Decompresses "lz4" or "zstd" frames, or copies the bytes for "". The result must have exactly `size`
/// bytes.
std::vector<std::uint8_t> unpack_chunk(std::string_view compression, std::span<const std::uint8_t> packed,
                                       std::uint64_t size, const SourcePlace& place, const std::string& what);

}  // namespace tubefoot
