// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "run/selection.hpp"
#include "sensors/recordings/run_context.hpp"

// This header declares the options of a run, as the command line and Python set them.
namespace tubefoot {

/// Options of several commands. An unset option means that the scene file decides.
struct CommonOptions {
  std::filesystem::path scene;
  std::optional<std::string> arithmetic;
  std::optional<int> threads;
  bool confined = false;  ///< if true, nothing outside of the scene file's folder is read
  bool quiet = false;
};

/// Pings `first` to `last`, both included; the default is all pings.
struct PingRange {
  std::int64_t first = 0;
  std::int64_t last = -1;
};

/// Parses "3", "2:5", ":5" or "2:". Throws std::invalid_argument with the expected form.
PingRange parse_ping_range(const std::string& text);

struct RunOptions : CommonOptions {
  std::filesystem::path output;
  Selection selection;
  PictureSettings pictures;
  std::optional<std::string>
      without;  ///< names of files that are not written, between commas; omitted_files()
  std::optional<std::string> engine;
  std::optional<std::string> binning;
  std::optional<std::string> sampling;
  std::optional<std::int64_t> rays, rays_per_beam;
  std::optional<std::uint64_t> seed;
  std::optional<std::string> coarsen;  ///< see RunRequest::coarseness
  bool reference = false;
  bool labels = false;
  std::optional<double> label_level_db;  ///< see RunRequest::label_level_db; only with `labels`
  std::optional<std::string> gradient;   ///< names of parameters, between commas; see RunRequest::gradient
  bool gradient_steps = false;           ///< see RunRequest::gradient_steps; only with `gradient`
  bool resume = false;
  std::optional<std::string> part;  ///< shard "2/8": only this part of the pings, in a file of its own
  /// With `reference`: relative bound of the energies, 1e-9 if unset. Otherwise a tolerance for
  /// parse_tolerance(), by which the run chooses its settings.
  std::optional<std::string> tolerance;
};

}  // namespace tubefoot
