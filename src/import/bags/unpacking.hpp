// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/input_error.hpp"

namespace tubefoot {

/// How much the packed parts of one recording unpack to, in all. A recording of a few megabytes that unpacks
/// to terabytes ends here, and not after hours.
class UnpackedBytes {
 public:
  /// `packed`: of all files of the recording.
  explicit UnpackedBytes(std::uint64_t packed);
  /// Throws InputError at `place` ("`what`: ...") where `bytes` more are too many.
  void add(std::uint64_t bytes, const SourcePlace& place, const std::string& what);
  std::uint64_t left() const { return most_ - taken_; }

 private:
  std::uint64_t most_, taken_ = 0;
};

bool is_zstd(std::span<const std::uint8_t> bytes);

/// What frames of zstd hold, at most `most` bytes. Throws InputError at `place` ("`what`: ...") for damage,
/// and for what is more than that or than the memory at hand, before it is unpacked further.
std::vector<std::uint8_t> unpack_zstd(std::span<const std::uint8_t> packed, std::uint64_t most,
                                      const SourcePlace& place, const std::string& what);

/// What frames of "lz4" or "zstd", or for "" the bytes themselves, hold: exactly `size` bytes.
std::vector<std::uint8_t> unpack_chunk(std::string_view compression, std::span<const std::uint8_t> packed,
                                       std::uint64_t size, const SourcePlace& place, const std::string& what);

}  // namespace tubefoot
