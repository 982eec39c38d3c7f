// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "run/survey.hpp"
#include "suite/suite_scene.hpp"

// The benchmark suite v2, from nothing: scenes, meshes, answers, checksums (docs/benchmark-suite.md).
namespace tubefoot {

struct SuiteRequest {
  std::optional<std::string> seed;  ///< the word of a validation set; none: the debug set
  std::vector<const Aspect*> scenes;
  bool answers = true;
  bool quiet = false;
};

/// The aspects of these names, in the order of the pack; all for an empty text. Names stand between commas.
/// Throws UsageError naming the nearest one.
std::vector<const Aspect*> aspects_named(const std::string& names);

/// What became of a scene.
struct WrittenScene {
  const Aspect* aspect = nullptr;
  std::size_t facets = 0;
  double energy_j = 0;        ///< sum of the answer
  std::size_t bins_over = 0;  ///< whose bound is wider than the scene promises
  double seconds = 0;         ///< of the clock
};

/// What else is written of each loaded scene, in forms of other programs, into the scene's folder.
using OtherForms = std::function<void(const Survey& survey, const std::filesystem::path& folder)>;

/// Writes a pack into a folder that is there and empty. Throws write_error(), and Interrupted when somebody
/// wants to stop.
std::vector<WrittenScene> write_suite(const std::filesystem::path& folder, const SuiteRequest& request,
                                      const OtherForms& other_forms = {});

}  // namespace tubefoot
