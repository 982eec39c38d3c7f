// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "import/frames/foreign_frame.hpp"

namespace tubefoot {

/// Declared properties of the pictures of another engine. Empty ones follow from the profile, the file or
/// the reference (docs/engine-validation.md).
struct ImportOptions {
  std::vector<std::filesystem::path> results;
  std::optional<std::filesystem::path> like, scene;  ///< exactly one of them is given
  /// Converts the reference to the units of the pictures for the tests.
  std::optional<std::filesystem::path> output_model;
  std::optional<std::string> sensor;
  std::filesystem::path output;
  std::string profile;
  std::string variable, range_variable, azimuth_variable;
  std::string topic;  ///< topic of a ROS 2 recording
  std::string order;  ///< range-first, beam-first or two-sided
  std::optional<bool> flip_beams, flip_range;
  std::string scale;         ///< energy, amplitude, db, db:REFERENCE or 8bit
  std::string azimuths;      ///< even, tangent, tangent:VIEWS, FILE.csv or FIRST:LAST
  std::string ranges;        ///< FIRST:LAST
  std::string range_origin;  ///< edges or centres
  std::string cartesian;     ///< fan or COLUMN:ROW:METRES
  std::string forward;       ///< up, down, left or right
  bool resample = false;     ///< resample to the bins of the reference
  bool strict = false;       ///< reject assumptions that the reference refutes
  bool confined = false;     ///< as in CommonOptions, for the scene
};

/// Sets the properties that the profile assumes for pictures like `first` and that the user did not
/// declare. Returns a description of them. Throws UsageError for an unknown profile.
std::vector<std::string> apply_profile(ImportOptions& options, const ForeignFrame& first);

/// Returns the names of the profiles.
std::vector<std::string> profile_names();

/// Returns all declared options as on the command line, to repeat the import.
std::string words_of(const ImportOptions& options);

}  // namespace tubefoot
