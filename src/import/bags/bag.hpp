// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "import/frames/foreign_frame.hpp"

namespace tubefoot {

/// Returns whether read_bag() reads a path. This is a folder with a metadata.yaml, or a name that ends in
/// .db3, .mcap (or either with .zstd), .cdr, .yaml or .yml.
bool is_bag(const std::filesystem::path& path);

/// Reads the pictures of one topic of a ROS 2 recording, in the order of their recording
/// (docs/engine-validation.md).
///
/// Without a topic, the function takes the only topic with pictures. For a single message (.cdr) or a
/// printed one (.yaml), `topic` is its type; without it, the function takes the only type that matches.
/// Throws InputError. Throws UsageError, with a list of all topics, if a topic must be chosen or does not
/// exist.
ForeignData read_bag(const std::filesystem::path& path,
                     const std::optional<std::string>& topic = std::nullopt);

}  // namespace tubefoot
