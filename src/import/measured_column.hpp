// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kmall/kmall_survey.hpp"
#include "run/survey.hpp"

namespace tubefoot {

/// Result of write_measured_column().
struct MeasuredColumnReport {
  std::size_t sensors = 0, pings = 0, beams = 0;
  std::size_t clipped = 0, samples = 0;  ///< samples with the lowest code; all recorded samples
};

/// Writes a measured water column as an echo file with the variables of a run (docs/output-files.md).
/// `survey`: the scene that write_kmall_scene() makes of `line`, whose sensors have the names of the modes.
/// The energy of a range bin is
/// 10^(level without gain / 10). The level without gain is that of the file minus X log10 R + 2 alpha R +
/// offset. R is the sound speed times half of the travel time. The calibration of the sonar is unknown, so
/// energies have an arbitrary unit. Samples with the lowest code, and bins that were not recorded, have the
/// energy 0. Further variables are `recorded_range_min`, `recorded_range_max` and `detected_range`, per ping
/// and beam. The last one is NaN without a detection and outside of the swath. Throws InputError if a sensor
/// of the scene lacks or has other beams or pings, and for invalid datagrams.
MeasuredColumnReport write_measured_column(const std::filesystem::path& file, const KmallSurvey& line,
                                           const Survey& survey);

}  // namespace tubefoot
