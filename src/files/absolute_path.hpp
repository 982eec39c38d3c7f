// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace tubefoot {

/// Returns an absolute name and keeps links and "..". Throws UsageError for a relative name if the current
/// folder does not exist any more.
std::filesystem::path absolute_path(const std::filesystem::path& file);

/// Returns the system's message about a file in the form of tubefoot's messages: "'a/b': Permission
/// denied".
std::string message_of(const std::filesystem::filesystem_error& error);

}  // namespace tubefoot
