// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sensors/products/received.hpp"

namespace tubefoot {

/// Widths of the beam on each side.
struct TwoSidedWidths {
  double along_track_deg = 0, across_track_deg = 0;
};

/// Writes the operator's files of a sonar with a beam to either side, from the received energies
/// (`received`), ping by ping. Returns the names of the files (docs/sensors.md):
/// - <sensor>.xtf, with attitude and navigation; needs a georeferenced scene;
/// - <sensor>-waterfall.png: 16-bit grey, the codes of the XTF file, one row per ping;
/// - <sensor>-mosaic.tif: amplitudes corrected for slant range on the map, and its picture
///   <sensor>-mosaic.png.
/// Files that cannot be made of this recording are omitted, and `warnings` has the reasons. Throws
/// std::runtime_error that names the file and the failed operation.
std::vector<std::filesystem::path> write_two_sided_files(const std::filesystem::path& folder,
                                                         const Recording& recording, const RunContext& run,
                                                         const TwoSidedWidths& widths,
                                                         std::vector<std::string>& warnings);

/// Names of these products (SensorKind::products()).
std::vector<std::string> two_sided_file_products();

/// True unless all of these files are omitted.
bool writes_two_sided_files(const Recording& recording, const RunContext& run);

/// Side of the mosaic's cells [m]: the distance between pings or three range samples, whichever is larger.
/// It is rounded up to 1, 2 or 5 times a power of ten. For a long line it is larger, so that there are at
/// most four million cells.
double mosaic_cell_m(const Recording& recording);

/// The files that cannot be written, with reasons, as far as they are known before echoes exist.
std::vector<std::string> two_sided_files_left_out(const Recording& recording, const RunContext& run);

}  // namespace tubefoot
