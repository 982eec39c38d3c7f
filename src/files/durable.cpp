// SPDX-License-Identifier: GPL-3.0-or-later

// Synchronises files and names with the disk, and replaces a file or a folder atomically. Replacing uses an
// exchange of two names where the file system supports it.

#include "files/durable.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include "files/checked_file.hpp"
#include "files/descriptor.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& place, int cause) {
  throw write_error(place, std::string("cannot be written to the disk: ") + std::strerror(cause));
}

bool synced(const Descriptor& file) {
  int status = 0;
  do {
    status = fsync(file.number());
  } while (status != 0 && errno == EINTR);
  return status == 0;
}

[[noreturn]] void cannot_move(const fs::path& target, int cause) {
  throw write_error(target, std::string("cannot be moved to this name: ") + std::strerror(cause));
}

bool renamed(const fs::path& from, const fs::path& to) { return std::rename(from.c_str(), to.c_str()) == 0; }

bool exchanged(const fs::path& a, const fs::path& b) {
  return renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

/// Synchronises the names with the disk. On failure it calls `undo` and throws.
template <class Undo>
void sync_or(const fs::path& target, const Undo& undo) {
  try {
    sync_names_in(target.parent_path());
  } catch (...) {
    undo();
    throw;
  }
}

}  // namespace

void sync_files_in(const fs::path& folder) {
  std::vector<std::pair<fs::path, Descriptor>> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.is_symlink()) continue;
    Descriptor file = open_own(entry.path(), O_RDONLY);
    if (!file) fail(entry.path(), errno);
    // Writing of all files starts before the first wait.
    sync_file_range(file.number(), 0, 0, SYNC_FILE_RANGE_WRITE);
    constexpr std::size_t most_open = 100;
    files.emplace_back(entry.path(), std::move(file));
    if (files.size() < most_open) continue;
    for (const auto& [name, open] : files)
      if (!synced(open)) fail(name, errno);
    files.clear();
  }
  for (const auto& [name, open] : files)
    if (!synced(open)) fail(name, errno);
  sync_names_in(folder);
}

void sync_names_in(const fs::path& folder) {
  const Descriptor open = open_own(folder, O_RDONLY | O_DIRECTORY);
  if (!open && errno == EACCES) return sync();  // the folder may be written but not read
  if (!open) fail(folder, errno);
  // Some other file systems report that they do not support the operation.
  if (!synced(open) && errno != EINVAL && errno != ENOSYS && errno != EOPNOTSUPP) fail(folder, errno);
}

void publish(const fs::path& staged, const fs::path& target) {
  std::error_code ignored;
  const bool replaces = fs::exists(fs::symlink_status(target, ignored));
  if (replaces && exchanged(staged, target)) return sync_or(target, [&] { exchanged(staged, target); });
  if (!replaces || !fs::is_directory(target, ignored)) {
    if (!renamed(staged, target)) cannot_move(target, errno);
    return sync_or(target, [&] {
      if (!replaces) renamed(target, staged);
    });
  }
  const fs::path earlier = staged.string() + earlier_suffix;
  if (!renamed(target, earlier)) cannot_move(target, errno);
  if (!renamed(staged, target)) {
    const int cause = errno;
    renamed(earlier, target);
    cannot_move(target, cause);
  }
  sync_or(target, [&] {
    renamed(target, staged);
    renamed(earlier, target);
  });
  renamed(earlier, staged);
}

}  // namespace tubefoot
