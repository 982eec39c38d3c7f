// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "import/frames/foreign_frame.hpp"

namespace tubefoot {

/// What is declared of the pictures of another engine; what is empty is as the profile, the file or the
/// reference has it (docs/import.md).
struct ImportOptions {
  std::vector<std::filesystem::path> results;
  std::optional<std::filesystem::path> like, scene;   ///< one of them
  std::optional<std::filesystem::path> output_model;  ///< of the measure in which the truth is looked at
  std::optional<std::string> sensor;
  std::filesystem::path output;
  std::string profile;
  std::string variable, range_variable, azimuth_variable;
  std::string topic;  ///< of a recording of ROS 2
  std::string order;  ///< range-first, beam-first or two-sided
  std::optional<bool> flip_beams, flip_range;
  std::string scale;         ///< energy, amplitude, db, db:REFERENCE or 8bit
  std::string azimuths;      ///< even, tangent, FILE.csv or FIRST:LAST
  std::string ranges;        ///< FIRST:LAST
  std::string range_origin;  ///< edges or centres
  std::string cartesian;     ///< fan or COLUMN:ROW:METRES
  std::string forward;       ///< up, down, left or right
  bool resample = false;     ///< onto the reference's bins
  bool strict = false;       ///< what the truth refutes is refused
  bool confined = false;     ///< of a scene
};

/// Fills in what a profile assumes of pictures as `first` is and nobody declared; returns what that is, in
/// words. Throws UsageError for a profile that there is not.
std::vector<std::string> apply_profile(ImportOptions& options, const ForeignFrame& first);

/// Names of profiles.
std::vector<std::string> profile_names();

/// All that was declared, as a command line has it: what makes the same again.
std::string words_of(const ImportOptions& options);

}  // namespace tubefoot
