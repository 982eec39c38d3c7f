// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

// Upper limits of the resources for a recording, whatever its files claim (docs/limits.md).
namespace tubefoot::limits {

/// Limits of one message, of a decompressed chunk of an MCAP file, and of a schema.
inline constexpr std::uint64_t message_bytes = std::uint64_t{1} << 30;
inline constexpr std::uint64_t schema_bytes = std::uint64_t{16} << 20;
/// Limit of the decompressed size of a recording that is compressed as a whole.
inline constexpr std::uint64_t unpacked_bytes = std::uint64_t{64} << 30;
/// Limit of the decompressed size of all compressed parts: a base, and so many bytes per byte of its files.
inline constexpr std::uint64_t unpacked_base_bytes = std::uint64_t{5} << 28, unpacked_per_byte = 100;
/// Limits of the number of messages of all topics, and of the number of files.
inline constexpr std::uint64_t bag_messages = 10'000'000, bag_files = 10'000;
/// Limits of a message as text (YAML), and of metadata.yaml.
inline constexpr std::uint64_t message_text_bytes = std::uint64_t{64} << 20,
                               metadata_bytes = std::uint64_t{16} << 20;

}  // namespace tubefoot::limits
