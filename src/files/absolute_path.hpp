// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace tubefoot {

/// A name from the root, with its links and ".." as they are. Throws UsageError for a relative name where the
/// current folder is no more, as it may be when somebody deletes it.
std::filesystem::path absolute_path(const std::filesystem::path& file);

/// What the system says about a file, in the words of a message: "'a/b': Permission denied".
std::string message_of(const std::filesystem::filesystem_error& error);

}  // namespace tubefoot
