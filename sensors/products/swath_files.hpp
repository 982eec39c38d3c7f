// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sensors/products/swath_formats.hpp"

namespace tubefoot {

/// Writes the records of a fan across the track (docs/sensors.md): soundings (<name>-soundings.csv, .gpkg)
/// and their grid (<name>-depth.tif, .png). A scene with a place on Earth adds <name>-sonar.nc, <name>.gsf
/// and <name>.xtf. Only some pings are in memory at a time. Returns the files' names. Throws
/// std::runtime_error that names the file and the failed operation.
std::vector<std::filesystem::path> write_swath_files(const std::filesystem::path& folder,
                                                     const Recording& recording, const RunContext& run,
                                                     const SwathSettings& settings,
                                                     std::vector<std::string>& warnings);

/// Names of these products (SensorKind::products()).
std::vector<std::string> swath_products();

/// The files that cannot be written, with reasons, as far as they are known before echoes exist.
std::vector<std::string> swath_files_left_out(const Recording& recording, const RunContext& run);

}  // namespace tubefoot
