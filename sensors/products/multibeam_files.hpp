// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/products/products.hpp"

namespace tubefoot {

/// Writes what a multibeam records (docs/sensors.md): soundings (<name>-soundings.csv, .gpkg), their grid
/// (<name>-depth.tif, .png) and, in a scene with a place on Earth, <name>-sonar.nc, <name>.gsf, <name>.xtf.
/// Some pings are in memory at a time. Returns the files' names; throws std::runtime_error naming the file
/// and what failed.
std::vector<std::filesystem::path> write_multibeam_files(const std::filesystem::path& folder,
                                                         const Recording& recording, const RunContext& run,
                                                         std::vector<std::string>& warnings);

/// Which of them there will not be, and why, as far as that can be said before there are echoes.
std::vector<std::string> multibeam_files_left_out(const Recording& recording, const RunContext& run);

}  // namespace tubefoot
