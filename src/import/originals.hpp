// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "files/atomic_output.hpp"

namespace tubefoot {

/// A file as it was when it was imported.
struct Original {
  std::string name;  ///< without its folder; of a recording's part, with that
  std::string sha256;
};

/// NAME.originals beside the echo file NAME.nc: each original under the hash of its bytes, and list.txt,
/// which has hashes and names in the order of the pictures.
class OriginalsFolder {
 public:
  /// Throws UsageError as OutputFolder does.
  OriginalsFolder(const std::filesystem::path& echo_file, const Inputs& inputs);
  const std::filesystem::path& path() const { return path_; }
  /// Copies; of a folder (a recording) its metadata.yaml and the files which that names. `azimuths` is no
  /// picture. Throws std::runtime_error where that fails.
  std::vector<Original> keep(const std::vector<std::filesystem::path>& pictures,
                             const std::optional<std::filesystem::path>& azimuths);
  void commit() { folder_.commit(); }

 private:
  std::filesystem::path path_;
  OutputFolder folder_;
};

/// The pictures of a folder of originals, in the order in which they were imported; nothing if it is none.
/// Throws InputError for one whose list or files are not what was written.
std::optional<std::vector<std::filesystem::path>> listed_originals(const std::filesystem::path& folder);

}  // namespace tubefoot
