// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace tubefoot {

/// Prepares netCDF, HDF5 and GDAL for isolated reading; call it before they read. HDF5 then loads no
/// external code for compression, and netCDF reads no settings from the working folder (.ncrc, .dodsrc). No
/// environment variable shifts the cells of a raster. Repeated calls have no effect.
void keep_libraries_to_themselves();

/// Removes environment variables that make libraries load code, read settings from files, write logs or
/// contact hosts. Only the scene and the command line determine a run, and such a file might be endless.
/// Places of installed data (PROJ_DATA, GDAL_DATA) stay.
/// Programs call this function before their first thread. A process that uses the library keeps its
/// environment.
void remove_library_variables();

/// Returns the name of a file without links to folders: the real folder and the file's own name, which may
/// be a link. GDAL, the scene hash and the file system could otherwise resolve ".." and links differently.
std::filesystem::path plain_name(const std::filesystem::path& file);

}  // namespace tubefoot
