// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace tubefoot {

/// Throws InputError at an HDF5 file (netCDF-4, BAG) that is not all there is to it: values in other files
/// (external storage, virtual datasets), links into other files or of kinds that a program must know. Only
/// its structure is looked at, no value is read. What has passed is remembered by its place on the disk, size
/// and time, so that a file that is opened once for each tile is looked at once.
void refuse_hdf5_references(const std::filesystem::path& file);

}  // namespace tubefoot
