// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/absolute_path.hpp"

#include <fmt/format.h>

#include "files/usage_error.hpp"

namespace tubefoot {

namespace fs = std::filesystem;

fs::path absolute_path(const fs::path& file) {
  if (file.empty() || file.is_absolute()) return file;
  std::error_code error;
  const fs::path here = fs::current_path(error);
  if (!error) return here / file;
  const std::string why =
      error == std::errc::no_such_file_or_directory ? "has been deleted" : "is unknown: " + error.message();
  throw UsageError(
      fmt::format("'{}': the current folder {}, so the relative name cannot be resolved; go to another "
                  "folder (cd), or give names that begin with '/'",
                  file.string(), why));
}

std::string message_of(const fs::filesystem_error& error) {
  return fmt::format("'{}': {}", error.path1().string(), error.code().message());
}

}  // namespace tubefoot
