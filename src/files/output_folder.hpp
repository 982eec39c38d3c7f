// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tubefoot {

/// A result folder that appears whole or not at all: files are written into a hidden folder beside it, which
/// takes its place at the end. An earlier result of tubefoot is replaced; anything else is never touched.
class OutputFolder {
 public:
  /// Throws UsageError if `target` holds files that tubefoot did not write or cannot be created.
  explicit OutputFolder(const std::filesystem::path& target);
  /// Removes what was not committed.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write until commit().
  const std::filesystem::path& staging() const { return staging_; }
  /// Writes the list of files and moves the folder to its place. Throws std::runtime_error if that fails; the
  /// earlier result is then still there.
  void commit();

 private:
  void clean_up();

  std::filesystem::path target_, staging_;
  std::vector<std::filesystem::path> made_parents_;  ///< innermost first
  bool committed_ = false;
};

/// Writes a file, whatever the bytes; throws std::runtime_error naming it if anything fails, a full disk
/// included.
void write_file(const std::filesystem::path& file, const std::string& bytes);

}  // namespace tubefoot
