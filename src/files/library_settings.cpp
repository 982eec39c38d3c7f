// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/library_settings.hpp"

#include <hdf5.h>

#include <cstdlib>
#include <mutex>

namespace tubefoot {

namespace fs = std::filesystem;

void keep_libraries_to_themselves() {
  static std::once_flag once;
  std::call_once(once, [] {
    setenv("NCRCENV_IGNORE", "1", 1);
    // A user's setting for another program would turn rasters upside down, or shift them by half a cell.
    for (const char* name : {"GDAL_NETCDF_BOTTOMUP", "GTIFF_POINT_GEO_IGNORE"}) unsetenv(name);
    H5PLset_loading_state(0);
  });
}

void remove_library_variables() {
  for (const char* name :
       {// netCDF: settings, which name hosts and files of their own.
        "NCRCENV_RC", "NCRCENV_HOME", "DAPRCFILE",
        // HDF5 and netCDF: code that is loaded for compression, for access to files, in place of HDF5.
        "HDF5_PLUGIN_PATH", "HDF5_PLUGIN_PRELOAD", "HDF5_DRIVER", "HDF5_DRIVER_CONFIG", "HDF5_VOL_CONNECTOR",
        // GDAL: settings; code of drivers and in virtual rasters; a log.
        "GDAL_CONFIG_FILE", "GDAL_DRIVER_PATH", "OGR_DRIVER_PATH", "GDAL_PYTHON_DRIVER_PATH", "PYTHONSO",
        "GDAL_VRT_ENABLE_PYTHON", "GDAL_VRT_PYTHON_TRUSTED_MODULES", "CPL_LOG",
        // PROJ: grids from hosts, more databases.
        "PROJ_NETWORK", "PROJ_NETWORK_ENDPOINT", "PROJ_AUX_DB",
        // OpenImageIO and what it reads with: code of formats, settings, which name such code.
        "OIIO_LIBRARY_PATH", "OPENIMAGEIO_PLUGIN_PATH", "OPENIMAGEIO_OPTIONS", "OCIO", "LIBHEIF_PLUGIN_PATH",
        // GLib and its pictures under librsvg: code.
        "GIO_EXTRA_MODULES", "GIO_MODULE_DIR", "GDK_PIXBUF_MODULE_FILE", "GDK_PIXBUF_MODULEDIR",
        // OpenSSL, which hashes: settings, which name code. The C library: code of character sets.
        "OPENSSL_CONF", "OPENSSL_MODULES", "OPENSSL_ENGINES", "GCONV_PATH"})
    unsetenv(name);
  // A folder of the user's or of the system's may have settings as well.
  setenv("NCRCENV_IGNORE", "1", 1);
  setenv("GDAL_CONFIG_FILE", "", 1);
  setenv("PROJ_NETWORK", "OFF", 1);
}

fs::path plain_name(const fs::path& file) {
  std::error_code error;
  const fs::path absolute = fs::absolute(file, error),
                 folder = fs::weakly_canonical(absolute.parent_path(), error);
  return error ? absolute.lexically_normal() : folder / absolute.filename();
}

}  // namespace tubefoot
