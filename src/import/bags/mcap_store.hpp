// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string_view>

#include "import/bags/byte_source.hpp"
#include "import/bags/message_store.hpp"
#include "import/bags/unpacking.hpp"

namespace tubefoot {

inline constexpr std::string_view mcap_magic{"\x89MCAP0\r\n", 8};

/// An MCAP file (mcap.dev/spec). All records of the data section are walked; the summary, an index for who
/// is in a hurry, is not believed. What chunks unpack to is added to `unpacked`. Messages that are read in
/// the order of their places unpack each chunk once. Throws InputError at the file.
std::unique_ptr<MessageStore> open_mcap_store(ByteSource source, UnpackedBytes& unpacked);

}  // namespace tubefoot
