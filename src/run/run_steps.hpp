// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "advice/advice.hpp"
#include "app/commands.hpp"
#include "run/survey.hpp"
#include "sensors/recordings/recording.hpp"

// The steps of a run that the command and the Python module share.
namespace tubefoot {

/// What a run is asked beside its engine and settings.
struct RunRequest {
  std::optional<double> reference_tolerance;  ///< of a reference: the relative bound
  std::optional<Tolerance> tolerance;         ///< picks the settings
};

/// Lets a run's options override the scene's own. Throws UsageError where they contradict each other.
RunRequest requested(const RunOptions& options, SceneDescription& description);

/// What makes two runs the same: the program's build, scene and everything it names, settings.
nlohmann::ordered_json asked_of(const SceneDescription& description, const RunRequest& request);

/// Puts the settings into the description that hold a tolerance most cheaply.
Advice pick_settings(SceneDescription& description, const Tolerance& tolerance, bool quiet);

/// Throws std::runtime_error if the scene file, or a file that it names, is no longer what was described: its
/// hash has changed, or it cannot be read.
void refuse_changed_input(const SceneDescription& description);

/// What computed the energies: the name of an engine of one's own, or of a built-in one.
std::string engine_name(const Survey& survey);

/// What an echo file says of where it comes from.
Provenance provenance_of(const Survey& survey, const std::optional<double>& reference_tolerance);

/// Which files a run will not write, and why, as far as that can be said before it.
std::vector<std::string> files_left_out(const Survey& survey);

/// Writes everything that a result folder holds but stats.json, and returns the names. Throws
/// std::runtime_error naming the file and what failed.
std::vector<std::filesystem::path> write_result_files(const std::filesystem::path& folder,
                                                      const Survey& survey,
                                                      const std::vector<Recording>& recordings,
                                                      const std::optional<double>& reference_tolerance,
                                                      std::vector<std::string>& warnings);

}  // namespace tubefoot
