// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "files/atomic_output.hpp"
#include "strength/strength_table.hpp"

namespace tubefoot {

/// Where target strengths are written: a table (.csv), netCDF (.nc), a picture (.png), or a folder with all
/// three. Complete or not there.
class StrengthOutput {
 public:
  /// Refuses places that cannot be written, before any work: throws UsageError.
  StrengthOutput(const std::filesystem::path& place, const Inputs& inputs);
  /// Throws std::runtime_error naming what could not be written.
  void write(const StrengthTable& table);

 private:
  std::optional<OutputFolder> folder_;
  std::optional<OutputFile> file_;
  std::string ending_;
};

/// One row a direction and frequency.
std::string to_csv(const StrengthTable& table);
void write_netcdf(const StrengthTable& table, const std::filesystem::path& file);
/// Lines of target strength over azimuth, or elevation, for up to five frequencies; over frequency for one
/// direction; a map where there are more.
void write_picture(const StrengthTable& table, const std::filesystem::path& file);

}  // namespace tubefoot
