// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "files/descriptor.hpp"

namespace tubefoot {

/// In every folder of tubefoot's: what it wrote there, so that only those files are ever replaced. While the
/// folder is being made its writer holds the lock of this file.
inline constexpr const char* list_name = ".tubefoot-files";

/// A hidden folder beside what is to be written, under a name that nobody else has, in which it is made. It
/// is taken away at the end with all that is still in it, and by the next one of the same target if the
/// program was killed: its lock, which is then free, proves it.
class Staging {
 public:
  /// `target`: an absolute path. Throws UsageError where its folder cannot be written or files there cannot
  /// be locked.
  Staging(const std::filesystem::path& target, mode_t mode);
  ~Staging();
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes the list of files, of all that is there now. Throws write_error().
  void write_list() const;

 private:
  std::filesystem::path target_, path_;
  Descriptor list_;
};

/// A folder within one that is being written, with those above it. Throws write_error().
void make_folder(const std::filesystem::path& folder);
/// A file within it gets another name. Throws write_error().
void rename_file(const std::filesystem::path& file, const std::filesystem::path& name);

/// What a file that is written in a Staging will be called; any other path as it is.
std::filesystem::path final_name(const std::filesystem::path& file);

}  // namespace tubefoot
