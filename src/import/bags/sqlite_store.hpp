// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "import/bags/message_store.hpp"

namespace tubefoot {

/// Opens a .db3 file written by rosbag2. Throws InputError at the file.
std::unique_ptr<MessageStore> open_sqlite_store(const std::filesystem::path& file);
/// Opens the decompressed bytes of a .db3 file. `file` is their origin.
std::unique_ptr<MessageStore> open_sqlite_store(const std::filesystem::path& file,
                                                std::vector<std::uint8_t> bytes);

}  // namespace tubefoot
