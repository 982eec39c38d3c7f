// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tubefoot {

/// Returns one line per file of `files`, in their order. Three or more names that differ only in the number
/// before their last word (camera-0000.png, camera-0001.png ...) share the line of the first.
std::vector<std::string> written_lines(const std::filesystem::path& folder,
                                       const std::vector<std::filesystem::path>& files);

}  // namespace tubefoot
