// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "import/frames/number_array.hpp"

namespace tubefoot {

/// How a file of pictures is read.
struct ReadOptions {
  WantedArrays arrays;
  std::string topic;  ///< of a recording of ROS 2; empty: the only one with pictures
};

/// The files that results name: folders of pictures stand for what is in them, and all are in the order of
/// their names, numbers in them by size (frame-9 before frame-10); a folder of originals has its own. Throws
/// InputError, for links out of a folder, too.
std::vector<std::filesystem::path> files_in_order(const std::vector<std::filesystem::path>& results);

/// Everything in a file of another engine, by what its first bytes say it is: NPY, NPZ, PNG, TIFF, OpenEXR,
/// netCDF, a recording of ROS 2 (is_bag()), else a matrix in text. Throws InputError; UsageError for
/// options that such a file has nothing for.
ForeignData read_foreign_file(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace tubefoot
