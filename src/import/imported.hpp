// SPDX-License-Identifier: GPL-3.0-or-later
// Converts pictures of another engine to a candidate for `compare`.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "import/candidate_file.hpp"
#include "import/import_options.hpp"

namespace tubefoot {

struct Imported {
  CandidateEchoes candidate;
  std::vector<std::string> told;   ///< how the pictures were read
  std::vector<std::string> found;  ///< assumptions that the reference confirms
  /// Assumptions that the reference refutes, and properties that `compare` will reject.
  std::vector<std::string> warnings;
};

/// A reference and the sensor in it to which the pictures belong.
struct ImportReference {
  WholeEchoFile file;
  std::size_t sensor = 0;
};

/// Returns the index of the named sensor, or of the only one. Throws UsageError.
std::size_t sensor_of(const WholeEchoFile& reference, const std::optional<std::string>& name);

/// Reads all results. Calls `reference_of` once, with the number of pings. Throws InputError and
/// UsageError. With `strict`, it also throws if the reference refutes an assumption.
Imported imported(ImportOptions options, const std::vector<std::filesystem::path>& files,
                  const std::function<const ImportReference&(std::size_t pings)>& reference_of);

}  // namespace tubefoot
