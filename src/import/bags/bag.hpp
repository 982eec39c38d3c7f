// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "import/frames/foreign_frame.hpp"

namespace tubefoot {

/// Whether a path is for read_bag(): a folder with a metadata.yaml, or a name that ends in .db3, .mcap (or
/// either with .zstd), .cdr, .yaml or .yml.
bool is_bag(const std::filesystem::path& path);

/// The pictures of one topic of a recording of ROS 2, in the order in which they were recorded; docs/
/// import-bags.md says what is read. Without a topic it is the only one that has pictures. Of a message that
/// was saved by itself (.cdr) or printed (.yaml), `topic` is its type, or none: then it is the one type that
/// fits. Throws InputError, and UsageError for a topic that must be chosen or is not there, with a list of
/// all topics.
ForeignData read_bag(const std::filesystem::path& path,
                     const std::optional<std::string>& topic = std::nullopt);

}  // namespace tubefoot
