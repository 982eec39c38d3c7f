// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace tubefoot {

/// Throws InputError at an HDF5 file (netCDF-4, BAG) that depends on more than its own bytes. Examples are
/// values in other files (external storage, virtual datasets), links into other files, and user-defined
/// links.
/// The check reads only the structure, no values. It remembers accepted files by place on disk, size and
/// time, so that a file that is opened for each tile is checked once.
void refuse_hdf5_references(const std::filesystem::path& file);

}  // namespace tubefoot
