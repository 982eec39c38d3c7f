// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "files/proj_confinement.hpp"

namespace tubefoot {

/// While an object exists, GDAL can open only the admitted files and its own tables on this thread, for
/// reading. The contents of a file cannot make GDAL open another file, an archive or a network address. Use
/// of GDAL by other parts of the program is not affected.
///
/// PROJ opens files without GDAL and is confined separately (ProjConfinement). Other libraries below GDAL
/// that open files themselves (netCDF, SQLite) get names that GdalInput has checked.
class GdalAccess {
 public:
  explicit GdalAccess(const std::vector<std::filesystem::path>& admitted);
  ~GdalAccess();
  GdalAccess(const GdalAccess&) = delete;
  GdalAccess& operator=(const GdalAccess&) = delete;

  /// Returns an existing file that a coordinate reference system names and that PROJ was not allowed to
  /// open; empty if there is none.
  const std::string& rejected_by_proj() const { return proj_.rejected(); }

 private:
  ProjConfinement proj_;
};

/// Registers the few GDAL drivers that tubefoot uses: for the formats of FileFormat, and to write GeoTIFF,
/// GeoPackage and GeoJSON. GDALAllRegister() is not used, because a file cannot exploit an absent driver.
void register_gdal_drivers();

/// While an object exists, GDAL writes a fixed date of change into GeoPackages, so that equal runs give equal
/// files.
class FixedGdalDate {
 public:
  FixedGdalDate();
  ~FixedGdalDate();
  FixedGdalDate(const FixedGdalDate&) = delete;
  FixedGdalDate& operator=(const FixedGdalDate&) = delete;
};

}  // namespace tubefoot
