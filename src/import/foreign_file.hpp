// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "import/frames/number_array.hpp"

namespace tubefoot {

/// Options for reading a file of pictures.
struct ReadOptions {
  WantedArrays arrays;
  std::string topic;  ///< topic of a ROS 2 recording; empty: the only topic with pictures
};

/// Lists the files of the results. A folder stands for the pictures in it. Files are ordered by name, with
/// numbers in names by size (frame-9 before frame-10); a folder of originals has its own order. Throws
/// InputError, also for links that lead out of a folder.
std::vector<std::filesystem::path> files_in_order(const std::vector<std::filesystem::path>& results);

/// Reads all frames of a file of another engine. The first bytes determine the format: NPY, NPZ, PNG, TIFF,
/// OpenEXR, netCDF, a ROS 2 recording (is_bag()), or otherwise a matrix as text. Throws InputError, and
/// UsageError for options that do not apply to the format.
ForeignData read_foreign_file(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace tubefoot
