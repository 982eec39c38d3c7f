// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace tubefoot {

/// Before netCDF or HDF5 read anything: netCDF reads no settings from the working folder (.ncrc, .dodsrc),
/// HDF5 loads no code for compression that it does not have itself, and nothing in the environment moves the
/// cells of a raster. Once; more often does no harm.
void keep_libraries_to_themselves();

/// Removes the variables of the environment that have libraries load code, read settings from files that they
/// name, write logs or call hosts: what a run does is in its scene and its command line, and nobody promises
/// that such a file ends. Where data are installed (PROJ_DATA, GDAL_DATA) stays. For programs, before their
/// first thread; a process around the library keeps its environment.
void remove_library_variables();

/// The name of a file without links to folders: its folder as it really is, and its own name, which may be a
/// link. Where GDAL, the scene hash and the file system could understand ".." and links in three ways, they
/// are given this.
std::filesystem::path plain_name(const std::filesystem::path& file);

}  // namespace tubefoot
