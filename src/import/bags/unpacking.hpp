// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/input_error.hpp"

namespace tubefoot {

bool is_zstd(std::span<const std::uint8_t> bytes);

/// What frames of zstd hold, at most `most` bytes. Throws InputError at `place` ("`what`: ...") for damage,
/// and for what is more than that or than the memory at hand, before it is unpacked further.
std::vector<std::uint8_t> unpack_zstd(std::span<const std::uint8_t> packed, std::uint64_t most,
                                      const SourcePlace& place, const std::string& what);

/// What frames of "lz4" or "zstd", or for "" the bytes themselves, hold: exactly `size` bytes.
std::vector<std::uint8_t> unpack_chunk(std::string_view compression, std::span<const std::uint8_t> packed,
                                       std::uint64_t size, const SourcePlace& place, const std::string& what);

}  // namespace tubefoot
