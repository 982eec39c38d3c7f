// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of another engine made a candidate for `compare`.
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
  std::vector<std::string> told;      ///< how the pictures were read
  std::vector<std::string> found;     ///< what the truth says of that
  std::vector<std::string> warnings;  ///< what it refutes, and what `compare` will not like
};

/// A reference, and which of its sensors the pictures are of.
struct ImportReference {
  WholeEchoFile file;
  std::size_t sensor = 0;
};

/// The one that is named, or the only one. Throws UsageError.
std::size_t sensor_of(const WholeEchoFile& reference, const std::optional<std::string>& name);

/// Reads all results. `reference_of` is asked once, for so many pings. Throws InputError and UsageError; with
/// `strict` also where the truth refutes what was assumed.
Imported imported(ImportOptions options, const std::vector<std::filesystem::path>& files,
                  const std::function<const ImportReference&(std::size_t pings)>& reference_of);

}  // namespace tubefoot
