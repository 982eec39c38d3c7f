// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace tubefoot {

/// What is heeded of the metadata.yaml of a recording that is a folder.
struct BagMetadata {
  std::vector<std::filesystem::path> files;  ///< in the folder, in their order
  std::optional<std::uint64_t> messages;     ///< of all topics
};

/// Throws InputError with the line; links that lead out of the folder are refused.
BagMetadata read_bag_metadata(const std::filesystem::path& folder);

}  // namespace tubefoot
