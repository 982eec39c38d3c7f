// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "run/options.hpp"
#include "run/run_request.hpp"
#include "run/survey.hpp"
#include "sensors/recordings/label_recording.hpp"
#include "sensors/recordings/recording.hpp"
#include "sensors/recordings/run_context.hpp"
#include "sensors/recordings/writing_cost.hpp"
#include "study/tolerance.hpp"

// The steps of a run that the command and the Python module share.
namespace tubefoot {

/// What a run of a scene is asked: its options override the scene's own. Throws UsageError where they
/// contradict each other.
RunRequest requested(const RunOptions& options, SceneDescription& description);

/// What makes two runs the same: the program's build, scene and everything it names, settings.
nlohmann::ordered_json request_json(const SceneDescription& description, const RunRequest& request);

/// Throws std::runtime_error if the scene file, or a file that it names, is no longer what was described: its
/// hash has changed, or it cannot be read.
void refuse_changed_input(const SceneDescription& description);

/// Pings of one's own engine, a reference and binnings that know of a footprint's centroid alone meet the
/// facets that the scene has.
Facets facets_for(const RunRequest& request);

/// What computed the energies: the name of an engine of one's own, or of a built-in one.
std::string engine_name(const RunRequest& request);

/// What an echo file says of where it comes from.
Provenance provenance_of(const Scene& scene, const RunRequest& request);

/// Which files a run will not write, and why, as far as that can be said before it; `with_bounds`: of a
/// reference run.
std::vector<std::string> files_left_out(const Survey& survey, const Selection& selection = {},
                                        bool with_bounds = false);

/// What writing the files of a run will take, and how large they may become, about (docs/performance.md).
WritingCost expected_writing(const Survey& survey, const RunRequest& request,
                             const PictureSettings& pictures);

/// How a result folder is written.
struct Writing {
  PictureSettings pictures{};
  bool quiet = true;  ///< nothing of it is reported on stderr
};

/// Writes everything that a result folder holds but stats.json, and returns the names. Of a sensor of which
/// only some beams were asked for there are echoes only: other files and pictures are of whole pings.
/// `label_recordings`: of each recording, or none. Throws std::runtime_error naming the file and what failed.
std::vector<std::filesystem::path> write_result_files(const std::filesystem::path& folder,
                                                      const Survey& survey, const RunRequest& request,
                                                      const std::vector<Recording>& recordings,
                                                      std::vector<std::string>& warnings,
                                                      const Writing& how = {},
                                                      std::span<const LabelRecording> label_recordings = {});

}  // namespace tubefoot
