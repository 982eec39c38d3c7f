// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "files/staging.hpp"

namespace tubefoot {

// Every file that a command writes goes through OutputFile or OutputFolder.
// 1. The output is complete or does not exist. Both write into a Staging in the folder of the target, which
//    takes the target's name at the end.
// 2. The output is durable. The bytes and the name are on disk when commit() returns.
// 3. The output never replaces an input, nor a file that another program wrote into a result folder.
// 4. The constructor finds unusable places before any computation, and throws UsageError.

/// Files that a command reads. No output may replace them.
using Inputs = std::vector<std::filesystem::path>;

/// Returns whether both names refer to one file, or would if it existed.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Writes a file. A link to a file stays a link. A target that is not a regular file (a pipe, /dev/stdout)
/// is written directly.
class OutputFile {
 public:
  OutputFile(const std::filesystem::path& target, const Inputs& inputs);

  /// Returns the file to write until commit().
  const std::filesystem::path& path();
  /// Throws write_error(); an earlier file then still exists.
  void commit();

 private:
  std::filesystem::path target_, path_;
  bool direct_ = false;
  std::optional<Staging> staging_;
};

/// Writes a folder. It replaces an earlier folder as a whole, if that holds only files that tubefoot wrote.
/// A link to a folder stays a link.
class OutputFolder {
 public:
  OutputFolder(const std::filesystem::path& target, const Inputs& inputs);
  /// Removes an output that was not committed.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Returns the folder to write until commit().
  const std::filesystem::path& staging() const { return staging_->path(); }
  /// Throws std::runtime_error; the earlier result then still exists.
  void commit();

 private:
  void make_parents();
  void remove_parents();

  std::filesystem::path target_;
  std::vector<std::filesystem::path> made_parents_;  ///< created parents, innermost last
  std::optional<Staging> staging_;
};

}  // namespace tubefoot
