// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "files/proj_confinement.hpp"

namespace tubefoot {

/// While one lives, GDAL opens on this thread the files that it was given and the tables that it came with,
/// to read them, and nothing else: whatever a file says, no other file, no archive, no address on a network
/// is there. What a program around this library does with GDAL outside of it stays as it is.
///
/// PROJ, which opens files past GDAL, is confined as well. Other libraries under GDAL that open files
/// themselves (netCDF, SQLite) get names that GdalInput has looked at before.
class GdalAccess {
 public:
  explicit GdalAccess(const std::vector<std::filesystem::path>& admitted);
  ~GdalAccess();
  GdalAccess(const GdalAccess&) = delete;
  GdalAccess& operator=(const GdalAccess&) = delete;

  /// An existing file that a coordinate reference system names, which PROJ was not allowed to open; empty:
  /// there was none.
  const std::string& rejected_by_proj() const { return proj_.rejected(); }

 private:
  ProjConfinement proj_;
};

/// Registers the few drivers of GDAL that are used here: for the formats of FileFormat, and to write GeoTIFF,
/// GeoPackage and GeoJSON. Not GDALAllRegister(): what is not there cannot be talked into anything.
void register_gdal_drivers();

}  // namespace tubefoot
