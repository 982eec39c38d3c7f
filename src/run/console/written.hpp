// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tubefoot {

/// A line for each of `files` in their order; where names differ in the number before their last word only
/// (camera-0000.png, camera-0001.png ...) and are three or more, one line at the first tells them all.
std::vector<std::string> written_lines(const std::filesystem::path& folder,
                                       const std::vector<std::filesystem::path>& files);

}  // namespace tubefoot
