// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kmall/kmall_survey.hpp"

namespace tubefoot {

/// How a scene is made of a survey line.
struct KmallSceneOptions {
  /// "grid" or "plane", fitted to the soundings of the file, or the name of a raster.
  std::string seabed = "grid";
  /// Cell size of the grid. Absent: 2.5 % of the mean depth, or more for a long line.
  std::optional<double> cell_m;
  double receive_shading = 0;  ///< shading of the receiver: line_amplitude()
  /// File of grazing angles and levels of the seabed (docs/environment.md); absent: Lambert's law.
  std::optional<std::filesystem::path> material_table;

  bool operator==(const KmallSceneOptions&) const = default;
};

/// Result of write_kmall_scene().
struct KmallSceneReport {
  std::size_t sensors = 0, pings = 0;
  std::vector<std::string> notes;  ///< assumptions, omissions and residuals, one line each
};

/// Writes a survey line as a scene into an existing folder: scene.toml, track.csv, with stratified water
/// profile.csv, and with a grid seabed.obj. The scene has a multibeam per mode, whose name is that of the
/// mode. Comments in scene.toml state the assumptions. Throws InputError for soundings that determine no
/// seabed, and std::runtime_error on a write error.
KmallSceneReport write_kmall_scene(const KmallSurvey& survey, const KmallSceneOptions& options,
                                   const std::filesystem::path& folder);

}  // namespace tubefoot
