// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "files/atomic_output.hpp"
#include "strength/strength_table.hpp"

namespace tubefoot {

/// Output of target strengths: a table (.csv), netCDF (.nc), a picture (.png), or a folder with all three.
/// It is written completely or not at all.
class StrengthOutput {
 public:
  /// Throws UsageError, before any computation, if the output cannot be written there.
  StrengthOutput(const std::filesystem::path& place, const Inputs& inputs);
  /// Throws std::runtime_error, which names the file, if writing fails.
  void write(const StrengthTable& table);

 private:
  std::optional<OutputFolder> folder_;
  std::optional<OutputFile> file_;
  std::string ending_;
};

/// Returns one row per direction and frequency.
std::string to_csv(const StrengthTable& table);
void write_netcdf(const StrengthTable& table, const std::filesystem::path& file);
/// Draws target strength over azimuth or elevation, one line for each of up to five frequencies. For a
/// single direction, it draws target strength over frequency. For more values, it draws a map. With a
/// comparison, each line has a diagram with both target strengths, and one with their difference.
void write_picture(const StrengthTable& table, const std::filesystem::path& file);

}  // namespace tubefoot
