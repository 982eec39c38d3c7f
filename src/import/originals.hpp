// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "files/atomic_output.hpp"

namespace tubefoot {

/// An imported file and its hash.
struct Original {
  std::string name;  ///< name without the folder; for a part of a recording, with its folder
  std::string sha256;
};

/// The folder NAME.originals next to the echo file NAME.nc. It contains each original under the hash of its
/// bytes, and list.txt with hashes and names in the order of the pictures.
class OriginalsFolder {
 public:
  /// Throws UsageError under the same conditions as OutputFolder.
  OriginalsFolder(const std::filesystem::path& echo_file, const Inputs& inputs);
  const std::filesystem::path& path() const { return path_; }
  /// Copies the files. For the folder of a recording, it copies metadata.yaml and the files that it names.
  /// `azimuths` is an additional file that is not a picture. Throws std::runtime_error on failure.
  std::vector<Original> keep(const std::vector<std::filesystem::path>& pictures,
                             const std::optional<std::filesystem::path>& azimuths);
  void commit() { folder_.commit(); }

 private:
  std::filesystem::path path_;
  OutputFolder folder_;
};

/// Returns the pictures of a folder of originals, in the order of their import, or nothing for another
/// folder. Throws InputError if its list or files were changed.
std::optional<std::vector<std::filesystem::path>> listed_originals(const std::filesystem::path& folder);

}  // namespace tubefoot
