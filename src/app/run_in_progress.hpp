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
#include "run/options.hpp"
#include "run/run_request.hpp"
#include "run/run_warnings.hpp"
#include "run/settings.hpp"
#include "run/simulation.hpp"
#include "run/survey.hpp"
#include "sensors/recordings/label_recording.hpp"

// The steps that commands share which end in a result folder: run, and join of what was run in parts.
namespace tubefoot {

/// What the steps of a run hand on to each other.
struct RunInProgress {
  explicit RunInProgress(const RunOptions& requested) : options(requested) {}

  const RunOptions& options;
  RunRequest request;
  nlohmann::ordered_json identity;  ///< for who goes on with it or shares it
  const std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  SimulationStats stats;
  std::size_t kept_pings = 0;  ///< of a run before, that this one goes on with
  int threads = 0;
  std::optional<int> ranks, parts;  ///< several processes that computed it, if so
  double simulation_seconds = 0, write_seconds = 0;
  double expected_write_seconds = 0;             ///< foresee_writing()
  std::vector<LabelRecording> label_recordings;  ///< if asked for
  RunWarnings warnings{
      [this](const std::string& warning, bool) { print_warnings({warning}, options.quiet); }};
};

/// Says what writing will take where that is much, and that the disk is too small. Throws UsageError for
/// pictures that contradict each other.
void foresee_writing(RunInProgress& run, const Survey& survey);

/// Sums and recordings of a store that has all pings, and what is to be said of them.
std::vector<Recording> looked_back(RunInProgress& run, const Survey& survey,
                                   const std::shared_ptr<PingStore>& store);

/// Names of all files written. `expected`: warnings that were given before.
std::vector<std::filesystem::path> write_all(RunInProgress& run, const Survey& survey,
                                             const std::vector<Recording>& recordings,
                                             const std::vector<std::string>& expected, OutputFolder& output);

/// What a run says at its end.
void tell_all(const RunInProgress& run, const LoadedScene& loaded_scene,
              const std::vector<std::filesystem::path>& files);

double seconds_since(std::chrono::steady_clock::time_point start);

}  // namespace tubefoot
