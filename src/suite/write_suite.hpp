// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "run/survey.hpp"
#include "suite/suite_scene.hpp"

// Writes the benchmark suite: scenes, meshes, reference answers and checksums (docs/reference-results.md).
namespace tubefoot {

struct SuiteRequest {
  const SuiteVersion& version;
  std::optional<std::string> seed;  ///< seed word of a validation set; empty for the debug set
  std::vector<const Aspect*> scenes;
  bool answers = true;
  bool quiet = false;
};

/// Returns the aspects with these names, in the order of the version. Names are separated by commas; an
/// empty text means all. Throws UsageError that names the nearest aspect.
std::vector<const Aspect*> aspects_named(const SuiteVersion& version, const std::string& names);

/// Summary of one written scene.
struct WrittenSuiteScene {
  const Aspect* aspect = nullptr;
  std::size_t facets = 0;
  std::string result{};       ///< summary of the answer, with its unit
  std::size_t bins_over = 0;  ///< number of range bins whose bound is wider than the scene promises
  double seconds = 0;         ///< elapsed wall-clock time
};

/// Writes a loaded scene in the formats of other programs into the folder of the scene.
using OtherForms = std::function<void(const Survey& survey, const std::filesystem::path& folder)>;

/// Writes a suite into an existing empty folder. Throws write_error(), and Interrupted on a stop request.
std::vector<WrittenSuiteScene> write_suite(const std::filesystem::path& folder, const SuiteRequest& request,
                                           const OtherForms& other_forms = {});

}  // namespace tubefoot
