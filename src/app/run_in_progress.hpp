// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "files/atomic_output.hpp"
#include "run/checkpoint/ping_store.hpp"
#include "run/omitted_files.hpp"
#include "run/options.hpp"
#include "run/run_request.hpp"
#include "run/run_warnings.hpp"
#include "run/settings.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
#include "sensors/recordings/label_recording.hpp"

// Steps that the commands `run` and `join` share. Both end in a result folder.
namespace tubefoot {

/// State that the steps of a run pass on to each other.
struct RunInProgress {
  explicit RunInProgress(const RunOptions& requested) : options(requested) {}

  const RunOptions& options;
  RunRequest request;
  OmittedFiles omitted;
  nlohmann::ordered_json identity;  ///< identifies the run for processes that resume or share it
  const std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  SimulationStats stats;
  std::size_t kept_pings = 0;  ///< pings from an interrupted run that this run resumes
  int threads = 0;
  std::optional<int> ranks, parts;  ///< number of processes that computed the run, if there were several
  double simulation_seconds = 0, write_seconds = 0;
  double expected_write_seconds = 0;             ///< set by foresee_writing()
  std::vector<LabelRecording> label_recordings;  ///< empty unless labels are requested
  RunWarnings warnings{
      [this](const std::string& warning, bool) { print_warnings({warning}, options.quiet); }};
};

/// Estimates the duration and the disk space of writing, and prints them if they are large or the disk is
/// too small. Throws UsageError for contradictory options of pictures.
void foresee_writing(RunInProgress& run, const Survey& survey);

/// Returns the sums and recordings of a store that contains all pings. Adds the warnings that they cause.
std::vector<Recording> looked_back(RunInProgress& run, const Survey& survey,
                                   const std::shared_ptr<PingStore>& store);

/// Writes the result folder and returns the names of all files. `expected`: warnings that were printed
/// before.
std::vector<std::filesystem::path> write_all(RunInProgress& run, const Survey& survey,
                                             const std::vector<Recording>& recordings,
                                             const std::vector<std::string>& expected, OutputFolder& output);

/// Prints the summary of a run.
void tell_all(const RunInProgress& run, const LoadedScene& loaded_scene,
              const std::vector<std::filesystem::path>& files);

double seconds_since(std::chrono::steady_clock::time_point start);

}  // namespace tubefoot
