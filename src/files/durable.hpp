// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace tubefoot {

// What has been written lies in the system's memory until it is asked to bring it to the disk; a name lies in
// its folder, which is brought there apart. Each of these throws write_error().

/// Brings every file in `folder` to the disk, and the folder itself. Folders in it are left out.
void sync_files_in(const std::filesystem::path& folder);
/// Brings the names in a folder to the disk.
void sync_names_in(const std::filesystem::path& folder);

/// Puts a file or a folder, which must be on the disk, in the place of what is at `target`, if anything is,
/// and brings the names to the disk. At no moment is there neither, whenever the program may end or the power
/// may fail, where the file system can exchange two names; else a folder is away for a moment under the name
/// `staged` + earlier_suffix. What was at `target` is then at `staged`, or is gone. If it throws, `target` is
/// what it was, or, on a disk that fails again as that is brought back, whole and new.
void publish(const std::filesystem::path& staged, const std::filesystem::path& target);
inline constexpr const char* earlier_suffix = ".earlier";

}  // namespace tubefoot
