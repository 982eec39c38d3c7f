// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sensors/products/products.hpp"

namespace tubefoot {

/// Writes what a sidescan's operator works with, of the energies as received (`received`), ping by ping, and
/// returns the names of the files (docs/sensors.md):
/// <sensor>.xtf, with attitude and navigation; needs a georeferenced scene. <sensor>-waterfall.png: 16-bit
/// grey, the codes of the XTF file, a row a ping. <sensor>-mosaic.tif: amplitudes corrected for slant range
/// on the map, and <sensor>-mosaic.png of it to look at. What cannot be made of this recording is left out,
/// and `warnings` says why. Throws std::runtime_error naming the file and what failed.
std::vector<std::filesystem::path> write_sidescan_files(const std::filesystem::path& folder,
                                                        const Recording& recording, const RunContext& run,
                                                        std::vector<std::string>& warnings);

/// Side of the mosaic's cells [m]: the distance between pings or three range samples, whichever is larger, up
/// to the next 1, 2 or 5 times a power of ten; larger where the line is so long that there would be more than
/// four million cells.
double mosaic_cell_m(const Recording& recording);

/// Which of them there will not be, and why, as far as that can be said before there are echoes.
std::vector<std::string> sidescan_files_left_out(const Recording& recording, const RunContext& run);

}  // namespace tubefoot
