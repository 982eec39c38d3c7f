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
    // A user's setting for another program could flip rasters or shift them by half a cell.
    for (const char* name : {"GDAL_NETCDF_BOTTOMUP", "GTIFF_POINT_GEO_IGNORE"}) unsetenv(name);
    H5PLset_loading_state(0);
  });
}

void remove_library_variables() {
  for (const char* name :
       {// netCDF: settings that name hosts and files.
        "NCRCENV_RC", "NCRCENV_HOME", "DAPRCFILE",
        // HDF5 and netCDF: code for compression, for access to files, or instead of HDF5.
        "HDF5_PLUGIN_PATH", "HDF5_PLUGIN_PRELOAD", "HDF5_DRIVER", "HDF5_DRIVER_CONFIG", "HDF5_VOL_CONNECTOR",
        // GDAL: settings; code of drivers and in virtual rasters; a log.
        "GDAL_CONFIG_FILE", "GDAL_DRIVER_PATH", "OGR_DRIVER_PATH", "GDAL_PYTHON_DRIVER_PATH", "PYTHONSO",
        "GDAL_VRT_ENABLE_PYTHON", "GDAL_VRT_PYTHON_TRUSTED_MODULES", "CPL_LOG",
        // PROJ: grids from hosts and further databases.
        "PROJ_NETWORK", "PROJ_NETWORK_ENDPOINT", "PROJ_AUX_DB",
        // OpenImageIO and its libraries: code for formats, and settings that name such code.
        "OIIO_LIBRARY_PATH", "OPENIMAGEIO_PLUGIN_PATH", "OPENIMAGEIO_OPTIONS", "OCIO", "LIBHEIF_PLUGIN_PATH",
        // GLib and its picture loaders below librsvg: code.
        "GIO_EXTRA_MODULES", "GIO_MODULE_DIR", "GDK_PIXBUF_MODULE_FILE", "GDK_PIXBUF_MODULEDIR",
        // OpenSSL, which computes hashes: settings that name code. The C library: code for character sets.
        "OPENSSL_CONF", "OPENSSL_MODULES", "OPENSSL_ENGINES", "GCONV_PATH"})
    unsetenv(name);
  // The user's or the system's folders may contain settings as well.
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
