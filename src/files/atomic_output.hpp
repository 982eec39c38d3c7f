// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "files/staging.hpp"

namespace tubefoot {

// Every file that a command writes goes through one of these two. What they promise:
// - whole or not at all: it is written into a Staging beside its place, which it takes at the end;
// - durable: it lies on the disk, under its name, when commit() returns;
// - never over an input, and never over what somebody else wrote in a result folder;
// - unusable places are found by the constructor, which throws UsageError, before anything is computed.

/// Files that were read, or will be: no output may take their place.
using Inputs = std::vector<std::filesystem::path>;

/// Whether both names are of one file, or would be.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// A file. A link to a file stays a link. What is no ordinary file (a pipe, /dev/stdout) is written as it is.
class OutputFile {
 public:
  OutputFile(const std::filesystem::path& target, const Inputs& inputs);

  /// Where to write until commit().
  const std::filesystem::path& path();
  /// Throws write_error(); an earlier file is then still there.
  void commit();

 private:
  std::filesystem::path target_, path_;
  bool direct_ = false;
  std::optional<Staging> staging_;
};

/// A folder, replaced as a whole if it holds nothing but what tubefoot wrote. A link to a folder stays a
/// link.
class OutputFolder {
 public:
  OutputFolder(const std::filesystem::path& target, const Inputs& inputs);
  /// Removes what was not committed.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write until commit().
  const std::filesystem::path& staging() const { return staging_->path(); }
  /// Throws std::runtime_error; the earlier result is then still there.
  void commit();

 private:
  void make_parents();
  void remove_parents();

  std::filesystem::path target_;
  std::vector<std::filesystem::path> made_parents_;  ///< innermost last
  std::optional<Staging> staging_;
};

}  // namespace tubefoot
