// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "run/selection.hpp"
#include "sensors/recordings/run_context.hpp"

// What somebody asks of a run, on a command line or in Python.
namespace tubefoot {

/// Options that several commands share; unset means: as the scene file says.
struct CommonOptions {
  std::filesystem::path scene;
  std::optional<std::string> arithmetic;
  std::optional<int> threads;
  bool confined = false;  ///< nothing outside of the scene file's folder is read
  bool quiet = false;
};

/// Pings `first` to `last`, both included; the default is all of them.
struct PingRange {
  std::int64_t first = 0;
  std::int64_t last = -1;
};

/// "3", "2:5", ":5" or "2:"; throws std::invalid_argument saying what was expected.
PingRange parse_ping_range(const std::string& text);

struct RunOptions : CommonOptions {
  std::filesystem::path output;
  Selection selection;
  PictureSettings pictures;
  std::optional<std::string> engine;
  std::optional<std::string> binning;
  std::optional<std::string> sampling;
  std::optional<std::int64_t> rays, rays_per_beam;
  std::optional<std::uint64_t> seed;
  std::optional<std::string> coarsen;  ///< RunRequest::coarseness
  bool reference = false;
  bool labels = false;
  std::optional<double> label_level_db;  ///< RunRequest's; with `labels` only
  bool resume = false;
  std::optional<std::string> part;  ///< "2/8": only this part of the pings, into a file of its own
  /// Of a reference: its relative bound, 1e-9 if unset. Else as parse_tolerance() reads it: picks the
  /// settings.
  std::optional<std::string> tolerance;
};

}  // namespace tubefoot
