// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string_view>

namespace tubefoot {

/// What a file that a library reads is, by its first bytes alone.
enum class FileFormat {
  other,
  geotiff,
  bag,
  netcdf4,  ///< HDF5 that is no BAG
  netcdf_classic,
  ascii_grid,
  png,
  vrt,
  geopackage,
  geojson,
  shapefile,
  // Models of other programs, which Assimp reads.
  collada,
  gltf,         ///< JSON, whose buffers may be files of their own
  gltf_binary,  ///< GLB
  studio_3ds,
  fbx
};

/// Throws InputError at the file if it cannot be opened, or is two formats at once: which one a library would
/// take it for, nobody should have to guess.
FileFormat format_of(const std::filesystem::path& file);

/// As in messages: "GeoTIFF".
std::string_view name_of(FileFormat format);
/// The name of GDAL's driver that reads it; nullptr for other.
const char* gdal_driver_of(FileFormat format);
/// Whether Assimp reads it.
bool is_model(FileFormat format);
/// Whether HDF5 reads it.
bool is_hdf5(FileFormat format);

}  // namespace tubefoot
