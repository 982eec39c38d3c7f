// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string_view>

#include "import/bags/byte_source.hpp"
#include "import/bags/message_store.hpp"
#include "import/bags/unpacking.hpp"

namespace tubefoot {

inline constexpr std::string_view mcap_magic{"\x89MCAP0\r\n", 8};

/// Opens an MCAP file (mcap.dev/spec). It reads all records of the data section and ignores the summary
/// section, which is a redundant index. It adds the decompressed sizes of chunks to `unpacked`. Reading
/// messages in the order of their places decompresses each chunk once. Throws InputError at the file.
std::unique_ptr<MessageStore> open_mcap_store(ByteSource source, UnpackedBytes& unpacked);

}  // namespace tubefoot
