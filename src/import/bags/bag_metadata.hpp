// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace tubefoot {

/// The used entries of the metadata.yaml of a recording folder.
struct BagMetadata {
  std::vector<std::filesystem::path> files;  ///< files in the folder, in their order
  std::optional<std::uint64_t> messages;     ///< number of messages of all topics
};

/// Throws InputError with the line, also for links that lead out of the folder.
BagMetadata read_bag_metadata(const std::filesystem::path& folder);

}  // namespace tubefoot
