// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

// The most that a recording is given, whatever it asks for (docs/limits.md).
namespace tubefoot::limits {

/// Of one message, of a chunk of an MCAP file unpacked, and of a schema.
inline constexpr std::uint64_t message_bytes = std::uint64_t{1} << 30;
inline constexpr std::uint64_t schema_bytes = std::uint64_t{16} << 20;
/// Of a recording that is compressed as a whole, unpacked.
inline constexpr std::uint64_t unpacked_bytes = std::uint64_t{64} << 30;
/// Of all that a recording packs, unpacked: so many bytes, and so many more per byte of its files.
inline constexpr std::uint64_t unpacked_base_bytes = std::uint64_t{5} << 28, unpacked_per_byte = 100;
/// Messages of all topics of a recording, and its files.
inline constexpr std::uint64_t bag_messages = 10'000'000, bag_files = 10'000;
/// Of a message as text (YAML), and of metadata.yaml.
inline constexpr std::uint64_t message_text_bytes = std::uint64_t{64} << 20,
                               metadata_bytes = std::uint64_t{16} << 20;

}  // namespace tubefoot::limits
