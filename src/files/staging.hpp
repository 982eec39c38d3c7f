// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "files/descriptor.hpp"

namespace tubefoot {

/// File in every folder that tubefoot writes, with the list of its files. tubefoot replaces only these
/// files. The writer of an incomplete folder holds the lock of this file.
inline constexpr const char* list_name = ".tubefoot-files";

/// A hidden folder with a unique name in the folder of the target, where the output is created. The
/// destructor removes it with its remaining content. After a killed program, the next Staging of the same
/// target removes the folder, because its lock is free.
class Staging {
 public:
  /// `target` is an absolute path. Throws UsageError if its folder cannot be written or files there cannot
  /// be locked.
  Staging(const std::filesystem::path& target, mode_t mode);
  ~Staging();
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes the list of all files that exist now. Throws write_error().
  void write_list() const;

 private:
  std::filesystem::path target_, path_;
  Descriptor list_;
};

/// Creates a folder in a staging folder, with its parents. Throws write_error().
void make_folder(const std::filesystem::path& folder);
/// Renames a file in a staging folder. Throws write_error().
void rename_file(const std::filesystem::path& file, const std::filesystem::path& name);

/// Returns the final name of a file in a Staging; any other path is returned unchanged.
std::filesystem::path final_name(const std::filesystem::path& file);

}  // namespace tubefoot
