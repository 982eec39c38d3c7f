// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "import/bags/message_store.hpp"

namespace tubefoot {

/// A .db3 file as rosbag2 writes it. Throws InputError at the file.
std::unique_ptr<MessageStore> open_sqlite_store(const std::filesystem::path& file);
/// The same, unpacked from `file`.
std::unique_ptr<MessageStore> open_sqlite_store(const std::filesystem::path& file,
                                                std::vector<std::uint8_t> bytes);

}  // namespace tubefoot
