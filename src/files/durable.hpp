// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace tubefoot {

// Functions that write files and names durably. The system keeps written bytes in memory until they are
// synchronised with the disk. The name of a file belongs to its folder, which needs a synchronisation of
// its own. Each of these functions throws write_error().

/// Synchronises every file in `folder`, and the folder itself, with the disk. Subfolders are left out.
void sync_files_in(const std::filesystem::path& folder);
/// Synchronises the names in a folder with the disk.
void sync_names_in(const std::filesystem::path& folder);

/// Replaces `target`, if it exists, by a file or folder that is on disk, and synchronises the names.
/// Afterwards the earlier content of `target` is at `staged` or is removed.
/// If the file system can exchange two names, `target` exists at every moment, even if the program or the
/// power fails. Otherwise an earlier folder has the name `staged` + earlier_suffix for a moment.
/// If the function throws, `target` has its earlier content. If the disk fails again during this repair,
/// `target` is complete and new.
void publish(const std::filesystem::path& staged, const std::filesystem::path& target);
inline constexpr const char* earlier_suffix = ".earlier";

}  // namespace tubefoot
