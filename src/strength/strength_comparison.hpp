// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "strength/strength_table.hpp"

// Compares target strengths with those of another method or of a measurement.
namespace tubefoot {

/// Reads a CSV file with the columns azimuth_deg, frequency_hz and target_strength_db, and optionally
/// elevation_deg (otherwise 0). The table of `tubefoot strength` has these columns. Values of directions and
/// frequencies that are not requested are ignored. Throws InputError if none remains, or if two rows have
/// the same direction and frequency.
StrengthComparison read_comparison(const std::filesystem::path& file, const StrengthRequest& request);

/// Target strength of the table minus that of the comparison, in dB; NaN if the comparison has no value.
double difference_db(const StrengthTable& table, std::size_t elevation, std::size_t azimuth,
                     std::size_t frequency);

/// Differences over all directions at one frequency.
struct StrengthDifference {
  double frequency_hz = 0;
  std::size_t directions = 0;  ///< number of compared directions; 0: the rest is 0
  double median_db = 0, ninth_decile_db = 0, largest_db = 0;  ///< of absolute values
  std::size_t largest_elevation = 0, largest_azimuth = 0;     ///< indices of the largest
  double mean_db = 0;  ///< ratio of the mean cross-sections in dB, positive if that of the table is larger
};
/// Returns one entry per frequency.
std::vector<StrengthDifference> differences_of(const StrengthTable& table);
/// Describes the differences, one line per frequency.
std::string in_words(const std::vector<StrengthDifference>& differences, const StrengthTable& table);

}  // namespace tubefoot
