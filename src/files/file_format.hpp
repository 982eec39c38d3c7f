// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string_view>

namespace tubefoot {

/// Format of a file that a library reads, determined from its first bytes.
enum class FileFormat {
  other,
  geotiff,
  bag,
  netcdf4,  ///< HDF5 that is not a BAG
  netcdf_classic,
  ascii_grid,
  png,
  vrt,
  geopackage,
  geojson,
  shapefile,
  // Models of other programs, which Assimp reads.
  collada,
  gltf,  ///< JSON, whose buffers may be separate files
  gltf_binary,
  studio_3ds,
  fbx
};

/// Returns the format of a file. Throws InputError at the file if it cannot be opened. A file that has two
/// formats at once is an error, too, because a library might choose either.
FileFormat format_of(const std::filesystem::path& file);

/// Returns the name of a format in messages: "GeoTIFF".
std::string_view name_of(FileFormat format);
/// Returns the name of the GDAL driver that reads the format; nullptr for `other`.
const char* gdal_driver_of(FileFormat format);
/// Returns whether Assimp reads the format.
bool is_model(FileFormat format);
/// Returns whether HDF5 reads the format.
bool is_hdf5(FileFormat format);

}  // namespace tubefoot
