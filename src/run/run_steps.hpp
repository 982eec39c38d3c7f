// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "run/omitted_files.hpp"
#include "run/options.hpp"
#include "run/run_request.hpp"
#include "run/survey.hpp"
#include "sensors/recordings/label_recording.hpp"
#include "sensors/recordings/recording.hpp"
#include "sensors/recordings/run_context.hpp"
#include "sensors/recordings/writing_cost.hpp"
#include "study/tolerance.hpp"

// This header declares the steps of a run that the command and the Python module share.
namespace tubefoot {

/// Returns the request for a run of a scene. The options override the settings of the scene. Throws
/// UsageError if the options contradict each other.
RunRequest requested(const RunOptions& options, SceneDescription& description);

/// Returns the data that identify a run: the build of the program, the scene with all files that it names,
/// and the settings.
nlohmann::ordered_json request_json(const SceneDescription& description, const RunRequest& request);

/// Throws std::runtime_error if the scene file, or a file that it names, has changed since it was described.
/// This is the case if its hash differs, or if it cannot be read.
void refuse_changed_input(const SceneDescription& description);

/// Returns which facets the pings use. An engine of the user, a reference, and binnings that use only the
/// centroid of a footprint need the facets as given.
Facets facets_for(const RunRequest& request);

/// Returns the name of the engine that computes the energies: an engine of the user, or a built-in one.
std::string engine_name(const RunRequest& request);

/// Returns the provenance that an echo file records.
Provenance provenance_of(const Scene& scene, const RunRequest& request);

/// Returns messages about the files that a run will not write, with reasons, as far as these are known
/// before the run. `with_bounds`: whether the run is a reference. Files in `omitted` have no messages.
std::vector<std::string> files_left_out(const Survey& survey, const Selection& selection = {},
                                        bool with_bounds = false, const OmittedFiles& omitted = {});

/// Settings for writing a result folder.
struct Writing {
  PictureSettings pictures{};
  bool quiet = true;  ///< if true, progress is not reported on stderr
  OmittedFiles omitted{};
};

/// Returns the approximate time to write the files of a run, and their approximate size
/// (validation/performance.md).
WritingCost expected_writing(const Survey& survey, const RunRequest& request, const Writing& how);

/// Writes all files of a result folder except stats.json and scene.png, and returns their names. For a sensor
/// with a selection of beams it writes echoes only, because other files and pictures contain whole pings.
/// `label_recordings`: one per recording, or empty. Throws std::runtime_error naming the file and the
/// failure.
std::vector<std::filesystem::path> write_result_files(const std::filesystem::path& folder,
                                                      const Survey& survey, const RunRequest& request,
                                                      const std::vector<Recording>& recordings,
                                                      std::vector<std::string>& warnings,
                                                      const Writing& how = {},
                                                      std::span<const LabelRecording> label_recordings = {});

}  // namespace tubefoot
